#include "core/odometry/motion_models.hpp"

#include "core/base/trig.hpp"

namespace crspf {

Pose2 arc(double distance_m, double turn_rad) {
    // The chord has length distance * sinc(turn / 2) and points half the turn away from the start's heading: the same
    // curve as (2), without its division by R - L.
    const double half = 0.5 * turn_rad;
    const SinCos h = sin_cos(half);
    const double squared = half * half;
    const double sinc = squared < 1e-4 ? 1.0 - squared / 6.0 * (1.0 - squared / 20.0) : h.sin / half;
    const double chord_m = distance_m * sinc;
    return {.x_m = chord_m * h.cos, .y_m = chord_m * h.sin, .theta_rad = wrap_angle(turn_rad)};
}

Pose2 differential_motion(double left_m, double right_m, double wheel_span_m) {
    return arc(0.5 * (left_m + right_m), (right_m - left_m) / wheel_span_m);
}

Pose2 ackermann_motion(double speed_mps, double steering_rad, double wheel_base_m, double dt_s) {
    constexpr double kSteeringLimit_rad = radians(80.0);
    const double steering = steering_rad > kSteeringLimit_rad    ? kSteeringLimit_rad
                            : steering_rad < -kSteeringLimit_rad ? -kSteeringLimit_rad
                                                                 : steering_rad;
    const SinCos s = sin_cos(steering);
    const double distance_m = speed_mps * dt_s;
    return arc(distance_m, distance_m * (s.sin / s.cos) / wheel_base_m);
}

Pose2 imu_motion(double speed_mps, double yaw_rate_radps, double dt_s) {
    return arc(speed_mps * dt_s, yaw_rate_radps * dt_s);
}

}  // namespace crspf
