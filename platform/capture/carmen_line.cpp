#include "platform/capture/carmen_line.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "platform/capture/scan_beams.hpp"
#include "platform/files/fields.hpp"

namespace crspf {
namespace {

CarmenLine damaged(std::string reason) {
    CarmenLine line;
    line.kind = CarmenLine::Kind::kDamaged;
    line.damage = std::move(reason);
    return line;
}

// Reads `num_readings [readings]` into the beams. Returns the damage, or an empty string.
std::string parse_ranges(Fields& fields, const LidarParams& lidar, Scan& scan) {
    if (!fields.number(scan.count)) {
        return "the number of readings is missing";
    }
    if (scan.count == 0) {
        return "a scan without beams";
    }
    if (scan.count > capacity::kBeams) {
        return std::to_string(scan.count) + " beams, more than the " + std::to_string(capacity::kBeams) +
               " of capacity::kBeams";
    }
    for (std::uint32_t i = 0; i < scan.count; ++i) {
        float range_m = 0.0F;
        if (!fields.number(range_m)) {
            return "reading " + std::to_string(i + 1) + " of " + std::to_string(scan.count) +
                   " is missing or not a number";
        }
        set_beam(scan, i, range_m, lidar);
    }
    return {};
}

// Reads x, y, theta. False where one is missing; a pose that is not finite is left out.
bool parse_pose(Fields& fields, std::optional<Pose2>& pose) {
    Pose2 p;
    if (!fields.numbers(p.x_m, p.y_m, p.theta_rad)) {
        return false;
    }
    if (std::isfinite(p.x_m) && std::isfinite(p.y_m) && std::isfinite(p.theta_rad)) {
        pose = p;
    }
    return true;
}

// Every line ends with `ipc_timestamp ipc_hostname logger_timestamp`. Nothing may follow: a line whose count of
// readings is wrong would be read askew.
bool parse_tail(Fields& fields, double& stamp_s) {
    double logger_timestamp_s = 0.0;
    return fields.number(stamp_s) && std::isfinite(stamp_s) && !fields.word().empty() &&
           fields.number(logger_timestamp_s) && fields.at_end();
}

CarmenLine parse_odom(Fields& fields) {
    CarmenLine line;
    double tv = 0.0;
    double rv = 0.0;
    double acceleration = 0.0;
    if (!parse_pose(fields, line.P_odom_base) || !fields.numbers(tv, rv, acceleration) ||
        !parse_tail(fields, line.stamp_s)) {
        return damaged("ODOM: fields are missing, too many or not numbers");
    }
    line.kind = CarmenLine::Kind::kOdometry;
    return line;
}

CarmenLine parse_flaser(Fields& fields, const LidarParams& lidar, Scan& scan) {
    if (const std::string damage = parse_ranges(fields, lidar, scan); !damage.empty()) {
        return damaged("FLASER: " + damage);
    }
    CarmenLine line;
    std::optional<Pose2> P_odom_lidar;
    if (!parse_pose(fields, P_odom_lidar) || !parse_pose(fields, line.P_odom_base) ||
        !parse_tail(fields, line.stamp_s)) {
        return damaged("FLASER: fields behind the readings are missing, too many or not numbers");
    }
    // The line has no angles. SICK lasers see 180 degrees: 180 or 360 beams from the right on, 181 or 361 with both
    // ends.
    const std::uint32_t intervals = scan.count % 2 == 0 ? scan.count : std::max(scan.count - 1, 1U);
    finish_scan(scan, -kPi / 2.0, kPi / intervals, lidar.time_per_beam_s, lidar);
    line.kind = CarmenLine::Kind::kFrontLaser;
    return line;
}

CarmenLine parse_robotlaser(Fields& fields, const LidarParams& lidar, Scan& scan) {
    double laser_type = 0.0;
    double start_angle_rad = 0.0;
    double field_of_view_rad = 0.0;
    double resolution_rad = 0.0;
    double maximum_range_m = 0.0;
    double accuracy = 0.0;
    double remission_mode = 0.0;
    if (!fields.numbers(laser_type, start_angle_rad, field_of_view_rad, resolution_rad, maximum_range_m, accuracy,
                        remission_mode)) {
        return damaged("ROBOTLASER1: the laser's configuration is missing or not numbers");
    }
    LidarParams limited = lidar;
    if (maximum_range_m > lidar.range_min_m) {
        limited.range_max_m = std::min(lidar.range_max_m, maximum_range_m);
    }
    if (const std::string damage = parse_ranges(fields, limited, scan); !damage.empty()) {
        return damaged("ROBOTLASER1: " + damage);
    }
    const double sweep_rad = resolution_rad * (scan.count - 1);
    if (!(std::abs(start_angle_rad) <= 2.0 * kPi) || !(resolution_rad > 0.0) || !(sweep_rad <= 2.0 * kPi)) {
        return damaged("ROBOTLASER1: start angle or resolution beyond a full turn");
    }
    std::uint32_t remissions = 0;
    if (!fields.number(remissions)) {
        return damaged("ROBOTLASER1: the number of remissions is missing");
    }
    for (double remission = 0.0; remissions > 0; --remissions) {
        if (!fields.number(remission)) {
            return damaged("ROBOTLASER1: a remission is missing or not a number");
        }
    }
    CarmenLine line;
    std::optional<Pose2> P_odom_lidar;
    std::array<double, 5> motion_and_safety{};
    auto& [tv, rv, forward_safety, side_safety, turn_axis] = motion_and_safety;
    if (!parse_pose(fields, P_odom_lidar) || !parse_pose(fields, line.P_odom_base) ||
        !fields.numbers(tv, rv, forward_safety, side_safety, turn_axis) || !parse_tail(fields, line.stamp_s)) {
        return damaged("ROBOTLASER1: fields behind the readings are missing, too many or not numbers");
    }
    finish_scan(scan, start_angle_rad, resolution_rad, lidar.time_per_beam_s, lidar);
    line.kind = CarmenLine::Kind::kRobotLaser;
    return line;
}

CarmenLine parse_param(Fields& fields, const LidarParams& lidar) {
    const std::string_view name = fields.word();
    if (name != "robot_front_laser_max" && name != "laser_front_laser_max") {
        return {};
    }
    CarmenLine line;
    if (!fields.number(line.range_limit_m) || !(line.range_limit_m > lidar.range_min_m)) {
        return damaged("PARAM: the laser's largest range is no number above range_min_m");
    }
    line.kind = CarmenLine::Kind::kRangeLimit;
    return line;
}

bool is_message_name(std::string_view word) {
    const auto is_letter = [](char c) { return (c >= 'A' && c <= 'Z') || (c >= 'a' && c <= 'z'); };
    return is_letter(word.front()) && std::all_of(word.begin(), word.end(), [&](char c) {
               return is_letter(c) || (c >= '0' && c <= '9') || c == '_' || c == '-';
           });
}

}  // namespace

CarmenLine parse_carmen_line(std::string_view line, const LidarParams& lidar, Scan& scan) {
    Fields fields(line);
    const std::string_view name = fields.word();
    if (name == "FLASER") {
        return parse_flaser(fields, lidar, scan);
    }
    if (name == "ODOM") {
        return parse_odom(fields);
    }
    if (name == "ROBOTLASER1") {
        return parse_robotlaser(fields, lidar, scan);
    }
    if (name == "PARAM") {
        return parse_param(fields, lidar);
    }
    if (name.empty() || name.front() == '#' || is_message_name(name)) {
        return {};
    }
    return damaged("not a line of a CARMEN log");
}

bool looks_like_carmen(std::string_view line) {
    constexpr std::array<std::string_view, 9> kNames = {
        "FLASER", "RLASER", "ROBOTLASER1", "ROBOTLASER2", "RAWLASER1", "RAWLASER2", "ODOM", "PARAM", "SYNC"};
    const std::string_view name = Fields(line).word();
    return std::find(kNames.begin(), kNames.end(), name) != kNames.end();
}

}  // namespace crspf
