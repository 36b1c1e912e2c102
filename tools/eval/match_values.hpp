// What the match value says on a recorded run, at the poses of a trajectory and beside them: whether it tells a good
// pose from a bad one, and where the analyser's thresholds belong.
#pragma once

#include <array>
#include <cstddef>
#include <filesystem>
#include <vector>

#include "config/config.hpp"
#include "platform/files/trajectory.hpp"

namespace crspf::eval {

/// The match values m of (10), 0 to 2975, of all scans at poses so far beside the trajectory's.
struct MatchValues {
    double distance_m = 0.0;  ///< [m] to any side
    double turn_deg = 0.0;    ///< [deg] to either side
    std::size_t scans = 0;    ///< with a verdict: the map had seen enough of what they see
    double p01 = 0.0;         ///< one scan in a hundred lies below
    double median = 0.0;
    double p99 = 0.0;
};

/// Draws the scans one by one at the trajectory's poses, as a replay does at its own, and matches each with the map
/// that those before it have made. Deterministic. Throws InputError: as for_each_scan(); not one pose a scan.
[[nodiscard]] std::array<MatchValues, 4> match_values(const std::vector<std::filesystem::path>& logs,
                                                      const Config& config, const std::vector<TimedPose>& trajectory);

}  // namespace crspf::eval
