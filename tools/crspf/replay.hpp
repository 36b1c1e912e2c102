// The main job as a function: recorded runs in, poses and a map out. `crspf replay` prints what it returns; tests and
// experiments call it directly.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "config/config.hpp"
#include "core/slam/pipeline.hpp"
#include "platform/capture/log_reader.hpp"
#include "platform/files/grid_map.hpp"
#include "platform/files/trajectory.hpp"
#include "platform/service/tile_archive.hpp"
#include "tools/crspf/replay_job.hpp"

namespace crspf {

struct ReplayOutcome {
    Config config;                           ///< that was used
    std::vector<TimedPose> trajectory;       ///< one pose a scan, as known at that moment, at its recorded stamp
    std::vector<float> M;                    ///< match value (11) of each scan
    std::vector<float> time_per_scan_ms;     ///< processor time of the core, odometry since the last scan included
    LogCounts log;                           ///< summed over the logs
    std::vector<SourceReport> sources;       ///< of recordings of sensors
    double cpu_s = 0.0;                      ///< processor time of the whole replay, reading included
    std::uint64_t live_same = 0;             ///< poses equal, to the bit, to those of the service that was recorded
    std::uint64_t live_other = 0;            ///< and those that are not
    std::string digest;                      ///< SHA-256 of the poses' bits
    std::unique_ptr<Pipeline> pipeline;      ///< as it was after the last scan
    std::unique_ptr<TileArchive> far_tiles;  ///< of its map; in the directory for temporary files
};

/// Throws InputError: a log that cannot be read, or that holds no usable scan; a map that cannot be loaded.
[[nodiscard]] ReplayOutcome run_replay(const ReplayJob& job);

/// trajectory.tum, map.pgm, map.yaml, map.png and report.json in `directory`, which is made if need be. Each file
/// appears whole or not at all. Returns report.json's text.
std::string write_replay(const ReplayOutcome& outcome, const ReplayJob& job, const std::filesystem::path& directory);

}  // namespace crspf
