// Simulated sensor data as lines of a log that `crspf replay` reads.
#pragma once

#include <cmath>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "core/base/pose.hpp"
#include "tools/sim/imu_model.hpp"
#include "tools/sim/lidar_model.hpp"
#include "tools/sim/robot.hpp"
#include "tools/sim/stereo_pictures.hpp"

namespace crspf::sim {

/// Simulated time as a record tells it. [us]
[[nodiscard]] inline std::int64_t to_us(double seconds) {
    return static_cast<std::int64_t>(std::floor(seconds * 1e6 + 0.5));
}

struct OdometryRecord {
    std::int64_t stamp_us = 0;
    Pose2 P_odom_base;
    double speed_mps = 0.0;
    double turn_rate_radps = 0.0;
    EncoderCounts counts;
    ImuRecord imu;
    double curvature = 0.0;  ///< [rad/m] as the steering holds it; 0 of a differential robot
};

struct ScanRecord {
    std::int64_t stamp_us = 0;  ///< of beam 0
    EncoderCounts counts;       ///< at that time
    std::vector<int> range_mm;
};

/// A datagram of a spatial lidar.
struct PacketRecord {
    std::int64_t sent_ns = 0;
    std::uint16_t port = 0;
    std::vector<std::uint8_t> payload;
};

/// A pair of a stereo camera.
struct PictureRecord {
    std::int64_t stamp_us = 0;  ///< of the exposure
    Pose2 P_world_left;         ///< the left camera, at that time
    StereoPictures pictures;
};

class LogWriter {
 public:
    virtual ~LogWriter() = default;
    /// Each appends its lines to `out`. Records come in the order in which a robot's computer gets them: a scan when
    /// its sweep is over, so with an older stamp than the odometry before it. What is over by the stamp of one odometry
    /// record comes before the next.
    virtual void odometry(const OdometryRecord& record, std::string& out) = 0;
    virtual void scan(const ScanRecord& record, std::string& out) = 0;
    /// Logs of lines have no place for these two.
    virtual void packet(const PacketRecord& /*record*/, std::string& /*out*/) {}
    virtual void pictures(const PictureRecord& /*record*/, std::string& /*out*/) {}
};

/// CARMEN: PARAM, ODOM and ROBOTLASER1 lines. The robot pose in a ROBOTLASER1 line repeats the newest ODOM line, so
/// that differences between the poses of successive lines are motions.
[[nodiscard]] std::unique_ptr<LogWriter> carmen_writer(const LidarModel& lidar, const Pose2& P_base_lidar);

/// One line a scan: stamp [us], status, left and right encoder counts, 20 unused fields, ranges [mm].
[[nodiscard]] std::unique_ptr<LogWriter> urg_dat_writer();

}  // namespace crspf::sim
