// How well a robot that knows nothing of its place is found in a map: random scans of a recorded run, against the poses
// of a trajectory in the map's frame.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <vector>

#include "config/config.hpp"
#include "platform/files/grid_map.hpp"
#include "platform/files/trajectory.hpp"
#include "tools/eval/summary.hpp"

namespace crspf::eval {

struct RelocalizationOptions {
    std::size_t scans = 200;  ///< as many different ones as the run has, if it has fewer
    std::uint64_t seed = 1;   ///< of the choice
    double right_m = 0.3;     ///< [m] a place this near the trajectory's pose is right
    double right_deg = 5.0;   ///< [deg] and its heading this near
};

/// Shares are of scans.
struct RelocalizationReport {
    std::size_t scans = 0;
    std::size_t right = 0;            ///< found, and right
    std::size_t wrong = 0;            ///< found, and wrong: what must not happen
    std::size_t ambiguous = 0;        ///< another place explains the scan as well
    std::size_t ambiguous_right = 0;  ///< of these, the better place was the right one
    std::size_t not_found = 0;        ///< no place explains the scan
    std::size_t no_answer = 0;        ///< too few hits, or the bound of the work
    Summary share;                    ///< of a scan that the best place explains
    Summary runner_up;                ///< and the best other place
    Summary wrong_share;              ///< of the scan, by the place that was wrong
    Summary wrong_at_truth;           ///< and by the truth: if it is less, map and trajectory contradict each other
    Summary position_m;               ///< error where found and right
    Summary heading_deg;              ///< the same
    Summary time_s;                   ///< processor time of a search
    double load_s = 0.0;              ///< processor time of taking the map
    std::size_t memory_bytes = 0;     ///< that the search needs beside the map
};

/// Throws InputError: as for_each_scan(); not one pose a scan; a map that nothing can be found in.
[[nodiscard]] RelocalizationReport relocalize(const GridMap& map, const std::vector<std::filesystem::path>& logs,
                                              const Config& config, const std::vector<TimedPose>& trajectory,
                                              const RelocalizationOptions& options);

}  // namespace crspf::eval
