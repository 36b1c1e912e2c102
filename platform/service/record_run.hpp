// Records every configured source until it is told to stop.
#pragma once

#include <atomic>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "config/config.hpp"
#include "platform/capture/recorder.hpp"
#include "platform/service/live_source.hpp"

namespace crspf {

struct RecordStatus {
    struct Source {
        std::string name;
        std::string state;
        std::uint64_t records = 0;
        std::uint64_t samples = 0;  ///< scans of a lidar, motions of an odometer
        SourceCounts counts;
    };
    std::vector<Source> sources;
    RecorderCounters recorder;
    std::filesystem::path file;  ///< the one that is being written; empty: none
    std::string problem;         ///< why recording pauses; empty: it does not
    double elapsed_s = 0.0;
};

struct RecordJob {
    Config config;
    RecorderParams recorder;
    std::optional<double> duration_s;
    std::function<void(const RecordStatus&)> progress;  ///< once a second
    /// Opens a source; tests give simulated ones. Default: on the ports of this machine.
    std::function<std::unique_ptr<LiveSource>(const SourceConfig&, const LidarParams&)> open;
};

/// Each source has a thread of its own; files hold the configuration. Returns after `stop` or the duration. Throws
/// InputError: a configuration without sources, a directory that cannot be written to.
RecordStatus run_record(const RecordJob& job, const std::atomic<bool>& stop);

}  // namespace crspf
