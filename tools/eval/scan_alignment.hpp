// Lays one laser scan on another, by what the two saw alone: no map, no odometry. Made to be believed rather than to
// find something everywhere: where the two scans leave a doubt, the answer is the reason instead of a pose.
//
// An exhaustive correlative search of a window (after E. Olson, "Real-time correlative scan matching", ICRA 2009), then
// point-to-line ICP (after A. Censi, ICRA 2008) from each of the best places, so that a second place that fits as well
// is noticed.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "core/base/pose.hpp"
#include "core/base/trig.hpp"

namespace crspf::eval {

/// The hits of one scan.
struct ScanHits {
    Eigen::Vector2d lidar = Eigen::Vector2d::Zero();  ///< [m] place of the lidar in base_link
    double angle_increment_rad = radians(1.0);        ///< [rad] > 0
    std::vector<Eigen::Vector2f> points;              ///< [m] in base_link, in the order of the beams
};

enum class AlignmentVerdict : std::uint8_t {
    kGood,
    kTooFewPoints,  ///< one of the scans saw hardly anything
    kNoFit,         ///< hits of one scan lie where the other looked through, or the two hardly see the same walls
    kAmbiguous,     ///< another place in the window fits nearly as well
    kDegenerate,    ///< a direction is not observed: a bare corridor
    kAtWindowEdge,  ///< the best place may lie outside the window
};

struct ScanAlignment {
    AlignmentVerdict verdict = AlignmentVerdict::kTooFewPoints;
    Pose2 P_reference_scan;     ///< base_link of the scan seen from base_link of the reference; for kGood to 1 or 2 cm
    double inlier_share = 0.0;  ///< of the hits that the other scan can judge, both ways: those on its walls
    double runner_up_share = 0.0;  ///< score of the second best separate place over that of the best
    double observed_share = 0.0;   ///< share of the walls seen that hold the least observed direction
};

/// Half the extents of the search about the guess.
struct ScanWindow {
    double half_width_m = 2.5;             ///< [m] > 0, in x and y of the reference's base_link
    double half_turn_rad = radians(20.0);  ///< [rad] > 0
};

/// Hits farther than 25 m from the lidar are left out: the gaps between their beams hide the walls. Deterministic;
/// about 3 ms for scans of 180 beams.
[[nodiscard]] ScanAlignment align_scans(const ScanHits& reference, const ScanHits& scan,
                                        const Pose2& P_reference_scan_guess, const ScanWindow& window = {});

}  // namespace crspf::eval
