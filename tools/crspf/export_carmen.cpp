#include "tools/crspf/export_carmen.hpp"

#include <cmath>
#include <initializer_list>
#include <limits>

#include "tools/crspf/export_text.hpp"

namespace crspf {
namespace {

/// As a float that a reader takes to be at the largest range, and not below.
float at_or_beyond(double range_m) {
    const auto nearest = static_cast<float>(range_m);
    return static_cast<double>(nearest) >= range_m ? nearest
                                                   : std::nextafter(nearest, std::numeric_limits<float>::infinity());
}

Pose2 in_odom(const Odometry& odometry, const Pose2& P_map_base) {
    return inverse(odometry.P_map_odom()) * P_map_base;
}

bool is_odometry(const LogEvent& event) {
    switch (event.kind) {
        case LogEvent::Kind::kMotion:
        case LogEvent::Kind::kDifferential:
        case LogEvent::Kind::kAckermann:
        case LogEvent::Kind::kImu: return true;
        case LogEvent::Kind::kScan:
        case LogEvent::Kind::kCloud:
        case LogEvent::Kind::kPlace: break;
    }
    return false;
}

void append_numbers(std::string& line, std::initializer_list<double> values) {
    for (const double value : values) {
        line += ' ';
        append_digits(line, value);
    }
}

}  // namespace

CarmenExport::CarmenExport(const std::filesystem::path& file, const SlamParams& params)
    : file_(file),
      lidar_(params.lidar),
      no_return_m_(at_or_beyond(params.lidar.range_max_m)),
      obstacles_(params.obstacles, params.lidar),
      line_(
          "# CARMEN log file, exported by crspf; m, rad, s\n"
          "# Scans are stamped with their beam 0 and seen from above: stamp_offset_s and mount_inverted are done\n"
          "PARAM robot_frontlaser_offset") {
    append_numbers(line_, {lidar_.P_base_lidar.x_m});
    append_stamp(0.0);
    line_ += "PARAM laser_front_laser_max ";
    append_digits(line_, no_return_m_);
    append_stamp(0.0);
    file_.write(line_);
}

void CarmenExport::before(const LogEvent& event, const Odometry& odometry) {
    if (!zero_s_) {
        zero_s_ = event.recorded_stamp_s - (stamp_of(event) - Stamp{}).seconds();
    }
    if (!placed_ && is_odometry(event)) {  // the first motion is seen only where it began
        write_odometry(in_odom(odometry, odometry.pose()), recorded_s(stamp_of(event)));
    }
    if (event.kind == LogEvent::Kind::kScan) {
        write_scan(event.scan, odometry);
    } else if (event.kind == LogEvent::Kind::kCloud &&
               obstacles_.scan(*event.cloud, odometry.attitude(), obstacle_scan_)) {
        write_scan(obstacle_scan_, odometry);
    }
}

void CarmenExport::after(const LogEvent& event, const Odometry& odometry) {
    if (is_odometry(event)) {
        write_odometry(in_odom(odometry, odometry.pose()), recorded_s(stamp_of(event)));
    }
}

void CarmenExport::write_odometry(const Pose2& P_odom_base, double stamp_s) {
    const double dt_s = stamp_s - stamp_s_;
    if (moved_ && dt_s > 0.0) {
        const Pose2 motion = inverse(P_odom_base_) * P_odom_base;
        speed_mps_ = std::copysign(std::hypot(motion.x_m, motion.y_m), motion.x_m) / dt_s;
        turn_rate_radps_ = motion.theta_rad / dt_s;
    }
    moved_ = true;
    stamp_s_ = stamp_s;
    P_odom_base_ = P_odom_base;
    line_ = "ODOM";
    append_pose(P_odom_base);
    append_numbers(line_, {speed_mps_, turn_rate_radps_, 0.0});
    append_stamp(stamp_s);
    file_.write(line_);
}

void CarmenExport::write_scan(const Scan& scan, const Odometry& odometry) {
    line_ = "ROBOTLASER1 0";
    append_numbers(line_, {scan.angle_min_rad, scan.angle_increment_rad * (scan.count - 1.0), scan.angle_increment_rad,
                           lidar_.range_max_m, lidar_.range_noise_m});
    line_ += " 0 " + std::to_string(scan.count);
    for (std::uint32_t i = 0; i < scan.count; ++i) {
        line_ += ' ';
        switch (scan.beam[i]) {
            case Beam::kHit: append_digits(line_, scan.range_m[i]); break;
            case Beam::kNoReturn: append_digits(line_, no_return_m_); break;
            case Beam::kInvalid:
            case Beam::kClear: line_ += '0'; break;
        }
    }
    line_ += " 0";
    const Pose2 P_odom_base = in_odom(odometry, odometry.pose_at(scan.stamp));
    append_pose(P_odom_base * lidar_.P_base_lidar);
    append_pose(P_odom_base);
    append_numbers(line_, {speed_mps_, turn_rate_radps_, 0.0, 0.0, 0.0});
    append_stamp(recorded_s(scan.stamp));
    file_.write(line_);
}

void CarmenExport::append_pose(const Pose2& pose) {
    placed_ = true;
    append_numbers(line_, {pose.x_m, pose.y_m, pose.theta_rad});
}

/// Ends the line.
void CarmenExport::append_stamp(double stamp_s) {
    line_ += ' ';
    append_fixed(line_, stamp_s, 6);
    line_ += " crspf ";
    append_fixed(line_, stamp_s, 6);
    line_ += '\n';
}

}  // namespace crspf
