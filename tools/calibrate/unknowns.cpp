#include "tools/calibrate/unknowns.hpp"

#include <algorithm>
#include <array>
#include <iterator>

#include "core/base/trig.hpp"
#include "core/odometry/motion_models.hpp"

namespace crspf::calibrate {
namespace {

constexpr double kDegree = radians(1.0);
constexpr double kLongestGap_s = 1.0;
constexpr std::string_view kStraight = "straight drives";
constexpr std::string_view kTurns = "turns to both sides";

constexpr Unknown kLidarX{.section = "lidar",
                          .key = "x_m",
                          .unit = "m",
                          .per_unit = 1.0,
                          .get = [](const Config& c) { return c.slam.lidar.P_base_lidar.x_m; },
                          .set = [](Config& c, double v) { c.slam.lidar.P_base_lidar.x_m = v; },
                          .belief = 1.0,
                          .wanted = 0.02,
                          .shown_by = kTurns};
constexpr Unknown kLidarY{.section = "lidar",
                          .key = "y_m",
                          .unit = "m",
                          .per_unit = 1.0,
                          .get = [](const Config& c) { return c.slam.lidar.P_base_lidar.y_m; },
                          .set = [](Config& c, double v) { c.slam.lidar.P_base_lidar.y_m = v; },
                          .belief = 1.0,
                          .wanted = 0.02,
                          .shown_by = kTurns};
constexpr Unknown kLidarYaw{.section = "lidar",
                            .key = "yaw_deg",
                            .unit = "deg",
                            .per_unit = kDegree,
                            .get = [](const Config& c) { return c.slam.lidar.P_base_lidar.theta_rad; },
                            .set = [](Config& c, double v) { c.slam.lidar.P_base_lidar.theta_rad = v; },
                            .belief = 30.0 * kDegree,
                            .wanted = 0.5 * kDegree,
                            .shown_by = kStraight};
constexpr Unknown kStampOffset{.section = "lidar",
                               .key = "stamp_offset_s",
                               .unit = "s",
                               .per_unit = 1.0,
                               .get = [](const Config& c) { return c.slam.lidar.stamp_offset_s; },
                               .set = [](Config& c, double v) { c.slam.lidar.stamp_offset_s = v; },
                               .belief = 0.3,
                               .wanted = 0.02,
                               .shown_by = "turns that begin and end"};
constexpr Unknown kSpeedFactor{.section = "odometry",
                               .key = "speed_factor",
                               .unit = "",
                               .per_unit = 1.0,
                               .get = [](const Config& c) { return c.slam.odometry.speed_factor; },
                               .set = [](Config& c, double v) { c.slam.odometry.speed_factor = v; },
                               .belief = 0.2,
                               .wanted = 0.01,
                               .shown_by = kStraight};

constexpr std::array kWheels = {Unknown{.section = "odometry",
                                        .key = "left_wheel_factor",
                                        .unit = "",
                                        .per_unit = 1.0,
                                        .get = [](const Config& c) { return c.slam.odometry.left_wheel_factor; },
                                        .set = [](Config& c, double v) { c.slam.odometry.left_wheel_factor = v; },
                                        .belief = 0.2,
                                        .wanted = 0.01,
                                        .shown_by = kStraight},
                                Unknown{.section = "odometry",
                                        .key = "right_wheel_factor",
                                        .unit = "",
                                        .per_unit = 1.0,
                                        .get = [](const Config& c) { return c.slam.odometry.right_wheel_factor; },
                                        .set = [](Config& c, double v) { c.slam.odometry.right_wheel_factor = v; },
                                        .belief = 0.2,
                                        .wanted = 0.01,
                                        .shown_by = kStraight},
                                Unknown{.section = "odometry",
                                        .key = "wheel_span_m",
                                        .unit = "m",
                                        .per_unit = 1.0,
                                        .get = [](const Config& c) { return c.slam.odometry.wheel_span_m; },
                                        .set = [](Config& c, double v) { c.slam.odometry.wheel_span_m = v; },
                                        .belief = 0.5,
                                        .wanted = 0.01,
                                        .shown_by = kTurns},
                                kLidarX,
                                kLidarY,
                                kLidarYaw,
                                kStampOffset};

constexpr std::array kCar = {kSpeedFactor,
                             Unknown{.section = "odometry",
                                     .key = "wheel_base_m",
                                     .unit = "m",
                                     .per_unit = 1.0,
                                     .get = [](const Config& c) { return c.slam.odometry.wheel_base_m; },
                                     .set = [](Config& c, double v) { c.slam.odometry.wheel_base_m = v; },
                                     .belief = 1.0,
                                     .wanted = 0.05,
                                     .shown_by = kTurns},
                             Unknown{.section = "odometry",
                                     .key = "steering_offset_deg",
                                     .unit = "deg",
                                     .per_unit = kDegree,
                                     .get = [](const Config& c) { return c.slam.odometry.steering_offset_rad; },
                                     .set = [](Config& c, double v) { c.slam.odometry.steering_offset_rad = v; },
                                     .belief = 15.0 * kDegree,
                                     .wanted = 0.3 * kDegree,
                                     .shown_by = kStraight},
                             kLidarX,
                             kLidarY,
                             kLidarYaw,
                             kStampOffset};

constexpr std::array kImu = {kSpeedFactor,
                             Unknown{.section = "odometry",
                                     .key = "yaw_rate_bias_deg",
                                     .unit = "deg/s",
                                     .per_unit = kDegree,
                                     .get = [](const Config& c) { return c.slam.odometry.yaw_rate_bias_radps; },
                                     .set = [](Config& c, double v) { c.slam.odometry.yaw_rate_bias_radps = v; },
                                     .belief = 5.0 * kDegree,
                                     .wanted = 0.05 * kDegree,
                                     .shown_by = "standing still"},
                             kLidarX,
                             kLidarY,
                             kLidarYaw,
                             kStampOffset};

// A way that grows by what a vehicle did between two samples of a rate.
template <typename Sample, typename Motion>
std::vector<Moment> way_by_rates(const std::vector<Sample>& samples, const Motion& motion) {
    std::vector<Moment> way;
    way.reserve(samples.size());
    Pose2 pose;
    for (std::size_t i = 0; i < samples.size(); ++i) {
        const double dt_s = i == 0 ? 0.0 : (samples[i].stamp - samples[i - 1].stamp).seconds();
        if (dt_s > 0.0 && dt_s < kLongestGap_s) {
            pose = pose * motion(samples[i - 1], samples[i], dt_s);
        }
        way.push_back({.stamp = samples[i].stamp, .P_odom_base = pose});
    }
    return way;
}

}  // namespace

std::span<const Unknown> unknowns_of(Odometer odometer) {
    switch (odometer) {
        case Odometer::kWheels: return kWheels;
        case Odometer::kCar: return kCar;
        case Odometer::kImu: break;
    }
    return kImu;
}

std::optional<Pose2> place_at(const std::vector<Moment>& way, Stamp stamp) {
    const auto later =
        std::lower_bound(way.begin(), way.end(), stamp, [](const Moment& moment, Stamp s) { return moment.stamp < s; });
    if (later == way.begin() || later == way.end()) {
        return std::nullopt;
    }
    const Moment& a = *std::prev(later);
    const Moment& b = *later;
    const double u = static_cast<double>((stamp - a.stamp).ns) / static_cast<double>((b.stamp - a.stamp).ns);
    return interpolate(a.P_odom_base, b.P_odom_base, u);
}

std::vector<Moment> way_of(const Drive& drive, Odometer odometer, std::span<const double> values) {
    if (odometer == Odometer::kCar) {
        return way_by_rates(drive.car, [&](const AckermannSample& a, const AckermannSample& b, double dt_s) {
            return ackermann_motion(values[0] * 0.5 * (a.speed_mps + b.speed_mps),
                                    values[2] + 0.5 * (a.steering_rad + b.steering_rad), values[1], dt_s);
        });
    }
    if (odometer == Odometer::kImu) {
        return way_by_rates(drive.imu, [&](const ImuSample& a, const ImuSample& b, double dt_s) {
            return imu_motion(values[0] * 0.5 * (a.speed_mps + b.speed_mps),
                              0.5 * (a.yaw_rate_radps + b.yaw_rate_radps) - values[1], dt_s);
        });
    }
    std::vector<Moment> way;
    way.reserve(drive.wheels.size());
    Pose2 pose;
    for (const DifferentialSample& wheels : drive.wheels) {
        pose = pose * differential_motion(values[0] * wheels.left_m, values[1] * wheels.right_m, values[2]);
        way.push_back({.stamp = wheels.stamp, .P_odom_base = pose});
    }
    return way;
}

}  // namespace crspf::calibrate
