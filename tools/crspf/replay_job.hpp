// What is to be played, and how: of every command that plays recordings.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <vector>

#include "config/config.hpp"
#include "core/base/kernel.hpp"
#include "core/slam/localizer.hpp"

namespace crspf {

struct ReplayJob {
    /// Logs that are parts of one run, in order; or recordings of sensors, played together.
    std::vector<std::filesystem::path> logs;
    std::optional<Config> config;  ///< none: that of the recording, else the defaults
    double rate = 0.0;             ///< 1: as fast as it was recorded; 0: as fast as possible
    Kernel kernel = Kernel::kFastest;
    std::optional<std::filesystem::path> localize;  ///< map_server YAML: localise on it, leave it as it is
    std::optional<Pose2> initial_pose;              ///< of base_link in the map frame; default: its origin
    /// Called now and then with the share done, 0 to 1, and the scans so far.
    std::function<void(double, std::uint64_t)> progress;
    /// Called with each scan, null where it was a revolution's, and what came of it.
    std::function<void(const Scan*, const ScanResult&)> on_result;
};

}  // namespace crspf
