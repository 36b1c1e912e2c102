// Absolute trajectory error against a true trajectory, and the drift at the end of the run.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "core/base/pose.hpp"
#include "platform/files/trajectory.hpp"
#include "tools/eval/summary.hpp"

namespace crspf::eval {

enum class Alignment : std::uint8_t {
    kBestFit,    ///< least squares over all positions, rigid, no scale (Horn 1987, Umeyama 1991)
    kFirstPose,  ///< the first poses laid on each other
};

/// A direction in the truth frame, of length 1.
struct Direction {
    double x = 1.0;
    double y = 0.0;
};

struct AteOptions {
    double max_gap_s = 0.02;  ///< [s] a pose without a truth this near is left out
    Alignment alignment = Alignment::kBestFit;
    Direction along{};  ///< for EndError::along_m
};

/// Trajectory less truth at the last pair, with the first poses laid on each other whatever `alignment` says.
struct EndError {
    double position_m = 0.0;   ///< [m] without sign
    double along_m = 0.0;      ///< [m] its part along `AteOptions::along`
    double heading_deg = 0.0;  ///< [deg] [-180, 180)
};

struct AteReport {
    std::size_t unmatched = 0;  ///< poses of the trajectory that were left out
    Pose2 P_truth_map;          ///< the alignment
    Summary position_m;         ///< distance to the truth, after the alignment
    Summary heading_deg;        ///< difference of heading without sign, after the alignment
    EndError end;
};

/// Each pose of `trajectory`, in file order, is paired with the truth nearest in stamp. Nothing where no pose has one.
[[nodiscard]] std::optional<AteReport> absolute_trajectory_error(const std::vector<TimedPose>& trajectory,
                                                                 const std::vector<TimedPose>& truth,
                                                                 const AteOptions& options);

}  // namespace crspf::eval
