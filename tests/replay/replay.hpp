// A log from its file through the whole core, with a heap guard round every call of the core.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "config/config.hpp"
#include "core/slam/pipeline.hpp"
#include "platform/capture/log_reader.hpp"
#include "platform/files/trajectory.hpp"

namespace crspf::test {

struct Replay {
    std::vector<TimedPose> trajectory;  ///< a pose for each scan
    std::string digest;                 ///< SHA-256 over the bits of these poses
    bool finite = true;                 ///< none of them is NaN or infinite
    std::uint64_t core_calls = 0;       ///< on_motion(), on_wheel() and on_scan()
    std::uint64_t heap_calls = 0;       ///< within them
    LocalizerCounters pipeline;
    OdometryCounters odometry;
    LogCounts log;
    std::string error;  ///< what() of the InputError that ended the log early
};

struct ReplayOptions {
    Kernel kernel = Kernel::kFastest;
    std::function<void()> beside_scan = [] {};  ///< called with each on_scan(), under the same guard
};

/// Throws InputError where the log cannot be opened.
[[nodiscard]] Replay replay(const std::filesystem::path& log, const Config& config, const ReplayOptions& options = {});

}  // namespace crspf::test
