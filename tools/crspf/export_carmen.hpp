// A run as a CARMEN log, so that other SLAM programs can be run on it: ODOM and ROBOTLASER1 lines.
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "core/odometry/odometry.hpp"
#include "core/slam/obstacle_scan.hpp"
#include "core/slam/slam_params.hpp"
#include "platform/capture/log_reader.hpp"
#include "platform/files/atomic_file.hpp"

namespace crspf {

/// Whatever the odometer was, its poses in the odom frame, uncorrected by scans. A revolution of many lasers becomes
/// the scan of its obstacles. Stamps are on the repaired time line, a scan's is that of beam 0: what [lidar] says of
/// stamp_offset_s and mount_inverted is in them already. Beams are as they were measured: CARMEN has no time of a beam,
/// so nothing takes the motion out of them. What a beam says of nothing (invalid, or clear up to where what is known
/// ends) reads 0; no return reads as the largest range.
class CarmenExport {
 public:
    /// Throws InputError for a file that cannot be written, as the others do.
    CarmenExport(const std::filesystem::path& file, const SlamParams& params);

    /// Before the sample is played, and after: scans are placed by what the odometry knew when they were seen.
    void before(const LogEvent& event, const Odometry& odometry);
    void after(const LogEvent& event, const Odometry& odometry);
    /// The last call.
    void finish() { file_.commit(); }

 private:
    void write_scan(const Scan& scan, const Odometry& odometry);
    void write_odometry(const Pose2& P_odom_base, double stamp_s);
    [[nodiscard]] double recorded_s(Stamp stamp) const { return zero_s_.value_or(0.0) + (stamp - Stamp{}).seconds(); }
    void append_pose(const Pose2& pose);
    void append_stamp(double stamp_s);

    AtomicFile file_;
    LidarParams lidar_;
    float no_return_m_;
    ObstacleScanner obstacles_;
    Scan obstacle_scan_;
    std::string line_;
    std::optional<double> zero_s_;  ///< what the recording calls the beginning of the time line
    bool placed_ = false;           ///< a line has told where the robot is
    // Of the last ODOM line.
    double stamp_s_ = 0.0;
    Pose2 P_odom_base_;
    double speed_mps_ = 0.0;
    double turn_rate_radps_ = 0.0;
    bool moved_ = false;  ///< there was one
};

}  // namespace crspf
