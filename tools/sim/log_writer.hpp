// Simulated sensor data as lines of a log that `crspf replay` reads.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "core/base/pose.hpp"
#include "tools/sim/lidar_model.hpp"
#include "tools/sim/robot.hpp"

namespace crspf::sim {

struct OdometryRecord {
    std::int64_t stamp_us = 0;
    Pose2 P_odom_base;
    double speed_mps = 0.0;
    double turn_rate_radps = 0.0;
};

struct ScanRecord {
    std::int64_t stamp_us = 0;  ///< of beam 0
    EncoderCounts counts;       ///< at that time
    std::vector<int> range_mm;
};

class LogWriter {
 public:
    virtual ~LogWriter() = default;
    /// Each appends its lines to `out`. Records come in the order in which a robot's computer gets them: a scan when
    /// its sweep is over, so with an older stamp than the odometry before it.
    virtual void odometry(const OdometryRecord& record, std::string& out) = 0;
    virtual void scan(const ScanRecord& record, std::string& out) = 0;
};

/// CARMEN: PARAM, ODOM and ROBOTLASER1 lines. The robot pose in a ROBOTLASER1 line repeats the newest ODOM line, so
/// that differences between the poses of successive lines are motions.
[[nodiscard]] std::unique_ptr<LogWriter> carmen_writer(const LidarModel& lidar, const Pose2& P_base_lidar);

/// One line a scan: stamp [us], status, left and right encoder counts, 20 unused fields, ranges [mm].
[[nodiscard]] std::unique_ptr<LogWriter> urg_dat_writer();

}  // namespace crspf::sim
