// How well a trajectory agrees with itself where the robot comes back to a place. It needs no truth: the scan of the
// second visit is laid on the scan of the first (scan_alignment.hpp), and where the robot stood then, seen from where
// it had stood, is held against what the trajectory says.
#pragma once

#include <array>
#include <cstddef>
#include <filesystem>
#include <vector>

#include "core/base/pose.hpp"
#include "core/base/trig.hpp"
#include "platform/files/trajectory.hpp"
#include "tools/eval/logged_scans.hpp"
#include "tools/eval/scan_alignment.hpp"
#include "tools/eval/summary.hpp"

namespace crspf::eval {

struct LoopOptions {
    double least_path_m = 20.0;           ///< [m] driven between two visits of a place
    double nearby_m = 1.5;                ///< [m] so near, by the trajectory, two poses are one place
    double turn_max_rad = radians(45.0);  ///< [rad] and the headings so near that both scans see the same walls
    double end_m = 2.0;  ///< [m] path that is a loop's end: from its first revisit that could be measured
    ScanWindow window;   ///< errors up to this size are found; larger ones show as ends not measured
};

/// A stretch of the path on known ground: the robot has come back.
struct LoopEnd {
    double earlier_stamp_s = 0.0;  ///< [s] of the first visit; recorded stamps, as all here
    double later_stamp_s = 0.0;    ///< [s] of the first revisit that could be measured; if none could, of the first
    Pose2 P_map_later;             ///< where the robot was at that second stamp
    double length_m = 0.0;         ///< [m] path between the two stamps
    std::size_t revisits = 0;      ///< of the whole stretch
    std::size_t measured = 0;      ///< of those; with none the figures below are 0
    double late_m = 0.0;           ///< [m] path from the first revisit to the first measured one
    double position_m = 0.0;       ///< [m] largest error within LoopOptions::end_m
    double heading_deg = 0.0;      ///< [deg] likewise, without sign
};

struct LoopErrors {
    std::vector<LoopEnd> ends;  ///< in the order of the run
    Summary position_m;         ///< over all revisits that could be measured [m]
    Summary heading_deg;        ///< [deg] without sign
    std::size_t revisits = 0;
    std::array<std::size_t, 6> verdicts{};  ///< revisits by AlignmentVerdict; kGood includes the unconfirmed
    std::size_t unconfirmed = 0;            ///< aligned, but no second scan of the first visit says the same
};

/// The n-th pose is taken for the n-th scan's: throws InputError, with `file` for the trajectory, where the numbers
/// differ or their stamps do by more than a millisecond. Both are in file order, so stamps that run back do no harm.
void require_pose_per_scan(const std::vector<LoggedScan>& scans, const std::vector<TimedPose>& trajectory,
                           const std::filesystem::path& file);

/// One pose a scan, as above, else std::invalid_argument. The path is walked in steps of 0.25 m or 10 degrees. A
/// revisit counts as measured where the alignments with two scans of the first visit agree within 0.1 m and 2 degrees.
/// Good to 1 or 2 cm; the heading, while the robot spins and the log does not time its beams, to a few degrees only.
/// Deterministic; about 6 ms a revisit.
[[nodiscard]] LoopErrors loop_errors(const std::vector<LoggedScan>& scans, const std::vector<TimedPose>& trajectory,
                                     const LoopOptions& options = {});

}  // namespace crspf::eval
