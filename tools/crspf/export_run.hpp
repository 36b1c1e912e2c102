// A run in the forms that other programs want, all of them from one replay.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "platform/capture/log_reader.hpp"
#include "tools/crspf/replay_job.hpp"

namespace crspf {

struct ExportOutputs {
    using Path = std::optional<std::filesystem::path>;
    Path mcap = {};      ///< the channels of tools/view/DESIGN.md
    Path tum = {};       ///< trajectory
    Path kitti = {};     ///< the same, three rows of four numbers a pose; the axes stay x forward, y left, z up
    Path carmen = {};    ///< scans and odometry
    Path csv = {};       ///< a line a scan
    Path svg = {};       ///< path over map
    Path png = {};       ///< the same
    Path map = {};       ///< map_server's NAME.pgm and NAME.yaml
    Path planning = {};  ///< the same of a map to plan paths on
};

struct ExportOutcome {
    std::uint64_t scans = 0;
    std::vector<std::string> written;  ///< files
    LogCounts log;
    std::vector<SourceReport> sources;
    std::uint64_t map_refused = 0;  ///< writes
    std::string digest;             ///< as run_replay()'s
};

/// Each file appears whole or not at all. The job's rate and on_result are not looked at. Throws InputError: as
/// run_replay(); a file that cannot be written.
ExportOutcome export_run(const ReplayJob& job, const ExportOutputs& outputs);

}  // namespace crspf
