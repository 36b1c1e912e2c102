// What the odometer alone makes of recorded runs, without a scan. `crspf replay --odometry-only` prints what it
// returns.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "config/config.hpp"
#include "core/odometry/odometry.hpp"
#include "platform/capture/log_reader.hpp"
#include "platform/files/kitti_poses.hpp"
#include "platform/files/trajectory.hpp"
#include "tools/crspf/replay.hpp"

namespace crspf {

struct OdometryOutcome {
    std::vector<TimedPose> trajectory;   ///< of base_link, one pose a sample of the odometer
    std::vector<KittiPose> camera_path;  ///< of a stereo camera, in space
    std::uint64_t blind = 0;             ///< samples that the odometer did not measure
    OdometryCounters odometry;
    LogCounts log;  ///< summed over the logs
    std::vector<SourceReport> sources;
    double cpu_s = 0.0;  ///< processor time of everything
    std::string digest;  ///< SHA-256 of the poses' bits
};

/// Of `job` the logs, the configuration and the progress count. Throws InputError as run_replay() does, and where the
/// runs hold no sample of an odometer.
[[nodiscard]] OdometryOutcome run_odometry(const ReplayJob& job);

/// trajectory.tum and report.json, and poses.txt in KITTI's format where there is a camera, in `directory`, which is
/// made if need be. Each file appears whole or not at all. Returns report.json's text.
std::string write_odometry(const OdometryOutcome& outcome, const ReplayJob& job,
                           const std::filesystem::path& directory);

}  // namespace crspf
