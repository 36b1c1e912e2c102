// The main job as a function: recorded runs in, poses and a map out. `crspf replay` prints what it returns; tests and
// experiments call it directly.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "config/config.hpp"
#include "core/slam/pipeline.hpp"
#include "platform/capture/journal.hpp"
#include "platform/capture/log_reader.hpp"
#include "platform/files/grid_map.hpp"
#include "platform/files/trajectory.hpp"
#include "platform/service/tile_archive.hpp"

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

/// As the service that was recorded was timed.
[[nodiscard]] ScanTiming timing_of(const JournalEntry& live);

/// Throws InputError: a log that cannot be read, or that holds no usable scan; a map that cannot be loaded.
[[nodiscard]] ReplayOutcome run_replay(const ReplayJob& job);

/// trajectory.tum, map.pgm, map.yaml, map.png and report.json in `directory`, which is made if need be. Each file
/// appears whole or not at all. Returns report.json's text.
std::string write_replay(const ReplayOutcome& outcome, const ReplayJob& job, const std::filesystem::path& directory);

}  // namespace crspf
