// `crspf calibrate stereo` as a function: pictures of a chessboard in, how the cameras see out.
#pragma once

#include <cstddef>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "tools/calibrate/stereo_estimate.hpp"

namespace crspf {

struct StereoCalibrateJob {
    std::vector<std::filesystem::path> inputs;  ///< as for_each_pair()
    Board board;
    /// Called now and then: the pairs that were looked at, and those of them that are used.
    std::function<void(std::size_t, std::size_t)> progress;
};

struct StereoCalibrateOutcome {
    StereoEstimate estimate;
    std::size_t looked_at = 0;
    std::vector<std::string> without_board;  ///< pairs in which not both cameras see all of it
    std::size_t not_moved = 0;               ///< of recordings: the board is where it was
    std::size_t left_out = 0;                ///< of a recording that has more than are needed
    std::vector<std::string> worst;          ///< pairs that fit far worse than the others
    std::vector<std::string> doubts;         ///< "what; remedy": reasons not to trust it
};

/// Throws InputError: as for_each_pair() and estimate_stereo(); pictures of different sizes; cameras the wrong way
/// round; a program that was built without OpenCV.
[[nodiscard]] StereoCalibrateOutcome run_stereo_calibration(const StereoCalibrateJob& job);

}  // namespace crspf
