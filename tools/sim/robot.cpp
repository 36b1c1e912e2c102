#include "tools/sim/robot.hpp"

#include <algorithm>
#include <cmath>

#include "core/base/trig.hpp"

namespace crspf::sim {
namespace {

double towards(double from, double to, double step) {
    return from + std::clamp(to - from, -step, step);
}

}  // namespace

double RobotParams::metres_per_count() const {
    return 2.0 * kPi * wheel_radius_m / counts_per_turn;
}

Pose2 arc(double length_m, double angle_rad) {
    // The chord leads in the direction of half the turn.
    const double half = angle_rad / 2.0;
    const SinCos direction = sin_cos(half);
    const double shortening = std::abs(half) < 1e-4 ? 1.0 - half * half / 6.0 : direction.sin / half;
    const double chord_m = length_m * shortening;
    return {.x_m = chord_m * direction.cos, .y_m = chord_m * direction.sin, .theta_rad = wrap_angle(angle_rad)};
}

Pose2 Motion::pose_at(double seconds) const {
    return P_world_start * arc(speed_mps * seconds, turn_rate_radps * seconds);
}

EncoderCounts Motion::counts_at(double seconds) const {
    return {.left = static_cast<std::int64_t>(std::floor(left_counts + left_rate * seconds)),
            .right = static_cast<std::int64_t>(std::floor(right_counts + right_rate * seconds))};
}

RobotParams car() {
    RobotParams car;
    car.drive = Drive::kAckermann;
    car.radius_m = 1.0;
    car.speed_mps = 5.0;
    car.acceleration_mps2 = 1.5;
    car.turning_radius_m = 5.0;
    car.steering_radpms = 0.15;
    car.wheel_span_m = 1.55;
    car.wheel_base_m = 2.6;
    car.wheel_radius_m = 0.3;
    car.height_m = 1.8;
    car.lidar_height_m = 1.7;
    car.obstacle_range_m = 60.0;
    car.map_resolution_m = 0.05;
    car.arrived_m = 1.0;
    return car;
}

Robot::Robot(const RobotParams& params, const Pose2& P_world_start, std::uint64_t seed)
    : params_(params), random_(seed, RandomStream::kWheels), P_world_base_(P_world_start) {}

Motion Robot::advance(const Command& command, double seconds, double level) {
    speed_mps_ = towards(speed_mps_, command.speed_mps, params_.acceleration_mps2 * seconds);
    if (params_.drive == Drive::kDifferential) {
        const double wanted = std::clamp(command.turn_rate_radps, -params_.turn_rate_radps, params_.turn_rate_radps);
        turn_rate_radps_ = towards(turn_rate_radps_, wanted, params_.turn_acceleration_radps2 * seconds);
    } else if (command.speed_mps != 0.0) {
        const double limit = std::min(1.0 / params_.turning_radius_m, params_.turn_rate_radps / params_.speed_mps);
        const double wanted = std::clamp(command.turn_rate_radps / command.speed_mps, -limit, limit);
        curvature_ = towards(curvature_, wanted, params_.steering_radpms * seconds);
    }
    if (params_.drive == Drive::kAckermann) {
        turn_rate_radps_ = curvature_ * speed_mps_;
    }

    Motion motion{.P_world_start = P_world_base_,
                  .speed_mps = speed_mps_ * level,
                  .turn_rate_radps = turn_rate_radps_,
                  .left_counts = left_counts_,
                  .right_counts = right_counts_};
    const double half_span_m = params_.wheel_span_m / 2.0;
    const auto count_rate = [&](double wheel_mps, double scale) {
        const double slip_m = params_.slip * std::sqrt(std::abs(wheel_mps) * seconds) * random_.normal();
        return (wheel_mps * scale + slip_m / seconds) / params_.metres_per_count();
    };
    const double scale = 1.0 + params_.odom_scale_error;
    motion.left_rate = count_rate(speed_mps_ - turn_rate_radps_ * half_span_m, scale - params_.odom_bias / 2.0);
    motion.right_rate = count_rate(speed_mps_ + turn_rate_radps_ * half_span_m, scale + params_.odom_bias / 2.0);

    P_world_base_ = motion.pose_at(seconds);
    left_counts_ += motion.left_rate * seconds;
    right_counts_ += motion.right_rate * seconds;
    driven_m_ += std::abs(speed_mps_) * seconds;
    return motion;
}

void WheelOdometer::update(const EncoderCounts& counts, double seconds) {
    const double left_m = static_cast<double>(counts.left - before_.left) * params_.metres_per_count();
    const double right_m = static_cast<double>(counts.right - before_.right) * params_.metres_per_count();
    before_ = counts;
    const double length_m = (left_m + right_m) / 2.0;
    const double angle_rad = (right_m - left_m) / params_.wheel_span_m;
    P_odom_base_ = P_odom_base_ * arc(length_m, angle_rad);
    speed_mps_ = length_m / seconds;
    turn_rate_radps_ = angle_rad / seconds;
}

}  // namespace crspf::sim
