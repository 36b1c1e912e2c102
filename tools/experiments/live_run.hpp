// The service on a simulated robot in real time, within this process: what each of its threads used, how often each
// module ran; and its recording, played again.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "core/base/pose.hpp"
#include "core/slam/localizer.hpp"

namespace crspf::experiments {

/// A thread of the service, or several that share a row.
struct ModuleLoad {
    std::string name;
    double rate_hz = 0.0;
    double cpu_s = 0.0;              ///< while it was watched
    std::vector<double> share = {};  ///< of a core, for each interval
    double median_below_us = 0.0;    ///< a turn of it; 0: not known
    double max_us = 0.0;
    std::uint64_t misses = 0;  ///< of its deadline
};

/// A scan of the recording, played again.
struct LiveScan {
    ScanResult result;
    std::optional<Pose2> P_world_base;  ///< the true pose
};

struct LiveRun {
    double seconds = 0.0;            ///< watched
    std::vector<double> interval_s;  ///< end of each, from the beginning
    std::vector<ModuleLoad> modules;
    bool realtime = false;  ///< SCHED_FIFO was to be had
    std::uint64_t skipped_scans = 0;
    std::uint64_t undrawn = 0;     ///< scans for which the map's thread had no room
    std::uint64_t live_same = 0;   ///< poses of the replay that are the service's, to the bit
    std::uint64_t live_other = 0;  ///< and those that are not
    double replay_scan_ms = 0.0;   ///< mean processor time of a scan in the replay, its odometry included
    std::vector<LiveScan> scans;

    /// Of a core, all modules together.
    [[nodiscard]] double load() const;
};

/// @param directory for the line, the map and the recording; must be there
/// @param seconds of real time, from the first pose on
[[nodiscard]] LiveRun run_live(const std::filesystem::path& directory, double seconds,
                               const std::function<void(double)>& progress);

}  // namespace crspf::experiments
