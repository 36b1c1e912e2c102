#include "tools/calibrate/stereo_estimate.hpp"

#include <algorithm>
#include <cmath>
#include <opencv2/calib3d.hpp>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include "platform/files/input_error.hpp"

namespace crspf {
namespace {

using Points2 = std::vector<cv::Point2f>;
using Points3 = std::vector<cv::Point3f>;

constexpr double kStdDevsOfK3 = 3.0;  // by which k3 must differ from none

cv::Size size_of(const Board& board) {
    return {board.columns, board.rows};
}

Points2 points_of(const std::vector<BoardCorner>& corners) {
    Points2 points;
    for (const BoardCorner& c : corners) {
        points.emplace_back(static_cast<float>(c.x_px), static_cast<float>(c.y_px));
    }
    return points;
}

/// How far cornerSubPix may look: not up to the next corner.
int reach_of(const Points2& points, const cv::Size& size) {
    const auto width = static_cast<std::size_t>(size.width);
    double least = 1e9;
    for (std::size_t i = 0; i < points.size(); ++i) {
        if (i % width + 1 < width) {
            least = std::min(least, cv::norm(points[i] - points[i + 1]));
        }
        if (i + width < points.size()) {
            least = std::min(least, cv::norm(points[i] - points[i + width]));
        }
    }
    return std::clamp(static_cast<int>(0.4 * least), 2, 11);
}

double rms(double sum_of_squares, std::size_t count) {
    return std::sqrt(sum_of_squares / static_cast<double>(count));
}

struct OneCamera {
    cv::Mat matrix;
    cv::Mat distortion;
    std::vector<cv::Mat> turns;   ///< of the board, seen from the camera, as rotation vectors
    std::vector<cv::Mat> places;  ///< [m]
    cv::Mat stddev;
    double rms_px = 0.0;
};

OneCamera calibrate_one(const std::vector<Points3>& boards, const std::vector<Points2>& corners, const cv::Size& size,
                        bool with_k3) {
    OneCamera one;
    cv::Mat ignored;
    cv::Mat errors;
    one.rms_px = cv::calibrateCamera(boards, corners, size, one.matrix, one.distortion, one.turns, one.places,
                                     one.stddev, ignored, errors, with_k3 ? 0 : cv::CALIB_FIX_K3,
                                     cv::TermCriteria(cv::TermCriteria::COUNT + cv::TermCriteria::EPS, 100, 1e-9));
    return one;
}

/// Of a fit with k3: a coefficient that the pictures do not tell does harm where no corner was seen.
bool tells_k3(const OneCamera& with) {
    constexpr int kK3 = 4;                // in the distortion
    constexpr int kStdDevOfK3 = 4 + kK3;  // behind fx fy cx cy
    return std::abs(with.distortion.at<double>(kK3)) > kStdDevsOfK3 * with.stddev.at<double>(kStdDevOfK3);
}

CameraIntrinsics intrinsics_of(const cv::Mat& matrix, const cv::Mat& distortion) {
    CameraIntrinsics c{.fx_px = matrix.at<double>(0, 0),
                       .fy_px = matrix.at<double>(1, 1),
                       .cx_px = matrix.at<double>(0, 2),
                       .cy_px = matrix.at<double>(1, 2)};
    for (int i = 0; i < std::min(8, static_cast<int>(distortion.total())); ++i) {
        c.distortion[static_cast<std::size_t>(i)] = distortion.at<double>(i);
    }
    return c;
}

CameraIntrinsics stddev_of(const cv::Mat& s) {
    CameraIntrinsics c{
        .fx_px = s.at<double>(0), .fy_px = s.at<double>(1), .cx_px = s.at<double>(2), .cy_px = s.at<double>(3)};
    for (int i = 0; i < 5; ++i) {
        c.distortion[static_cast<std::size_t>(i)] = s.at<double>(4 + i);
    }
    return c;
}

CameraEstimate estimate_of(const OneCamera& one, const std::vector<Points2>& corners, const cv::Size& size) {
    Points2 all;
    for (const Points2& points : corners) {
        all.insert(all.end(), points.begin(), points.end());
    }
    const cv::Rect_<float> box = cv::boundingRect(all);
    return {.value = intrinsics_of(one.matrix, one.distortion),
            .stddev = stddev_of(one.stddev),
            .rms_px = one.rms_px,
            .wide = static_cast<double>(box.width) / size.width,
            .high = static_cast<double>(box.height) / size.height};
}

/// Standard deviation of the mean of what each pair alone tells of the distance between the cameras.
double baseline_stddev(const OneCamera& left, const OneCamera& right) {
    std::vector<double> distances;
    for (std::size_t i = 0; i < left.turns.size(); ++i) {
        cv::Mat R_left;
        cv::Mat R_right;
        cv::Rodrigues(left.turns[i], R_left);
        cv::Rodrigues(right.turns[i], R_right);
        distances.push_back(cv::norm(right.places[i] - R_right * R_left.t() * left.places[i]));
    }
    cv::Scalar mean;
    cv::Scalar stddev;
    cv::meanStdDev(distances, mean, stddev);
    return stddev[0] / std::sqrt(static_cast<double>(distances.size()));
}

class Estimation {
 public:
    Estimation(const std::vector<BoardPair>& pairs, const Board& board, const cv::Size& size)
        : pairs_(pairs), size_(size) {
        Points3 points;
        for (int row = 0; row < board.rows; ++row) {
            for (int column = 0; column < board.columns; ++column) {
                points.emplace_back(static_cast<float>(board.square_m * column),
                                    static_cast<float>(board.square_m * row), 0.0F);
            }
        }
        boards_.assign(pairs.size(), points);
        for (const BoardPair& pair : pairs) {
            left_.push_back(points_of(pair.left));
            right_.push_back(points_of(pair.right));
        }
    }

    StereoEstimate run() {
        StereoEstimate out;
        OneCamera left = calibrate_one(boards_, left_, size_, true);
        OneCamera right = calibrate_one(boards_, right_, size_, true);
        const bool with_k3 = tells_k3(left) || tells_k3(right);
        if (!with_k3) {
            left = calibrate_one(boards_, left_, size_, false);
            right = calibrate_one(boards_, right_, size_, false);
        }
        out.left = estimate_of(left, left_, size_);
        out.right = estimate_of(right, right_, size_);
        out.baseline_stddev_m = baseline_stddev(left, right);
        // First what is between them, then everything at once: that both see one board ties the centre of one picture
        // to that of the other, which decides about what is far away.
        fit_pair(left, right, cv::CALIB_FIX_INTRINSIC);
        out.rms_px = fit_pair(left, right, cv::CALIB_USE_INTRINSIC_GUESS | (with_k3 ? 0 : cv::CALIB_FIX_K3));
        out.left.value = intrinsics_of(left.matrix, left.distortion);
        out.right.value = intrinsics_of(right.matrix, right.distortion);
        cv::Mat turn;
        cv::Rodrigues(R_, turn);
        out.turned_rad = cv::norm(turn);
        out.baseline_m = cv::norm(T_);
        fill(out.calibration, out.left.value, out.right.value);
        fill(out, rectified_rows(left, right));
        return out;
    }

 private:
    using RowDifferences = std::vector<std::vector<double>>;

    double fit_pair(OneCamera& left, OneCamera& right, int flags) {
        cv::Mat E;
        cv::Mat F;
        return cv::stereoCalibrate(boards_, left_, right_, left.matrix, left.distortion, right.matrix, right.distortion,
                                   size_, R_, T_, E, F, errors_, flags,
                                   cv::TermCriteria(cv::TermCriteria::COUNT + cv::TermCriteria::EPS, 100, 1e-9));
    }

    void fill(StereoCalibration& c, const CameraIntrinsics& left, const CameraIntrinsics& right) const {
        c.width = size_.width;
        c.height = size_.height;
        c.left = left;
        c.right = right;
        std::copy(R_.begin<double>(), R_.end<double>(), c.R.begin());
        std::copy(T_.begin<double>(), T_.end<double>(), c.T_m.begin());
    }

    [[nodiscard]] RowDifferences rectified_rows(const OneCamera& left, const OneCamera& right) const {
        cv::Mat R_left;
        cv::Mat R_right;
        cv::Mat P_left;
        cv::Mat P_right;
        cv::Mat Q;
        cv::stereoRectify(left.matrix, left.distortion, right.matrix, right.distortion, size_, R_, T_, R_left, R_right,
                          P_left, P_right, Q, cv::CALIB_ZERO_DISPARITY, 0.0);
        RowDifferences rows;
        for (std::size_t i = 0; i < left_.size(); ++i) {
            Points2 a;
            Points2 b;
            cv::undistortPoints(left_[i], a, left.matrix, left.distortion, R_left, P_left);
            cv::undistortPoints(right_[i], b, right.matrix, right.distortion, R_right, P_right);
            std::vector<double>& of_pair = rows.emplace_back();
            for (std::size_t k = 0; k < a.size(); ++k) {
                of_pair.push_back(static_cast<double>(a[k].y) - static_cast<double>(b[k].y));
            }
        }
        return rows;
    }

    void fill(StereoEstimate& out, const RowDifferences& rows) const {
        double all = 0.0;
        std::size_t count = 0;
        for (std::size_t i = 0; i < pairs_.size(); ++i) {
            double sum = 0.0;
            for (const double d : rows[i]) {
                sum += d * d;
            }
            all += sum;
            count += rows[i].size();
            out.pairs.push_back({.name = pairs_[i].name,
                                 .left_px = errors_.at<double>(static_cast<int>(i), 0),
                                 .right_px = errors_.at<double>(static_cast<int>(i), 1),
                                 .rows_px = rms(sum, rows[i].size())});
        }
        out.rows_px = rms(all, count);
    }

    const std::vector<BoardPair>& pairs_;
    cv::Size size_;
    std::vector<Points3> boards_;
    std::vector<Points2> left_;
    std::vector<Points2> right_;
    cv::Mat R_;
    cv::Mat T_;
    cv::Mat errors_;  ///< [px] of each pair: left, right
};

}  // namespace

std::vector<BoardCorner> find_board(const GrayView& picture, const Board& board) {
    // cv::Mat knows no read-only pixels, and it is not written to.
    auto* const pixels = const_cast<std::uint8_t*>(picture.pixels);  // NOLINT(*-const-cast): see above
    const cv::Mat image(picture.height, picture.width, CV_8UC1, pixels, picture.stride);
    Points2 points;
    // Without CALIB_CB_FAST_CHECK, which overlooks boards that are there.
    const bool found = cv::findChessboardCorners(image, size_of(board), points,
                                                 cv::CALIB_CB_ADAPTIVE_THRESH | cv::CALIB_CB_NORMALIZE_IMAGE);
    if (!found) {
        return {};
    }
    const int reach = reach_of(points, size_of(board));
    cv::cornerSubPix(image, points, cv::Size(reach, reach), cv::Size(-1, -1),
                     cv::TermCriteria(cv::TermCriteria::COUNT + cv::TermCriteria::EPS, 50, 1e-3));
    std::vector<BoardCorner> corners;
    for (const cv::Point2f& p : points) {
        corners.push_back({.x_px = static_cast<double>(p.x), .y_px = static_cast<double>(p.y)});
    }
    return corners;
}

StereoEstimate estimate_stereo(const std::vector<BoardPair>& pairs, const Board& board, int width, int height) {
    if (pairs.size() < kBoardPairsMin) {
        throw InputError("the board is seen whole by both cameras in " + std::to_string(pairs.size()) + " pairs, and " +
                         std::to_string(kBoardPairsMin) + " are needed, better 30; take more pictures of it");
    }
    try {
        return Estimation(pairs, board, cv::Size(width, height)).run();
    } catch (const cv::Exception& e) {
        throw InputError("the pictures do not tell the cameras (" + e.err +
                         "); take them with the board tilted, at many places of the picture");
    }
}

}  // namespace crspf
