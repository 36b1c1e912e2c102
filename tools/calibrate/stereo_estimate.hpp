// How a pair of cameras sees, from pictures of a chessboard (Zhang, IEEE TPAMI 2000; by OpenCV).
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "core/base/gray_image.hpp"
#include "drivers/stereo/stereo_calibration.hpp"

namespace crspf {

/// Counted by inner corners, where four squares meet. Columns and rows differ, else nobody could tell how it is turned.
struct Board {
    int columns = 9;
    int rows = 6;
    double square_m = 0.025;
};

struct BoardCorner {
    double x_px = 0.0;
    double y_px = 0.0;
};

/// Corners row by row; empty where the board is not seen whole.
[[nodiscard]] std::vector<BoardCorner> find_board(const GrayView& picture, const Board& board);

/// What both cameras saw of the board at one moment.
struct BoardPair {
    std::string name;
    std::vector<BoardCorner> left;
    std::vector<BoardCorner> right;
};

struct CameraEstimate {
    CameraIntrinsics value;
    CameraIntrinsics stddev;  ///< by its own pictures alone; 0: held fixed
    double rms_px = 0.0;      ///< from corners to where they should be, each camera alone
    double wide = 0.0;        ///< share of the picture's width in which corners were seen
    double high = 0.0;        ///< and of its height
};

/// What is left over of one pair: root mean squares.
struct PairError {
    std::string name;
    double left_px = 0.0;
    double right_px = 0.0;
    double rows_px = 0.0;  ///< between the rows of a corner in both pictures, once rectified
};

struct StereoEstimate {
    StereoCalibration calibration;
    CameraEstimate left;
    CameraEstimate right;
    double baseline_m = 0.0;
    double baseline_stddev_m = 0.0;  ///< by how single pairs differ
    double turned_rad = 0.0;         ///< the right camera against the left one
    double rms_px = 0.0;             ///< of both cameras with one place of the board for both
    double rows_px = 0.0;
    std::vector<PairError> pairs;  ///< in the order given
};

inline constexpr std::size_t kBoardPairsMin = 8;

/// Each camera alone, then what is between them, then all at once. The distortion is k1 k2 p1 p2, and k3 where the
/// pictures tell it.
/// Throws InputError for fewer than kBoardPairsMin pairs and for pairs that do not tell the cameras.
[[nodiscard]] StereoEstimate estimate_stereo(const std::vector<BoardPair>& pairs, const Board& board, int width,
                                             int height);

}  // namespace crspf
