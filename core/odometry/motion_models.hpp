// The paper's motion models (Section 3): one interval's motion as a pose in the frame at the interval's start.
#pragma once

#include "core/base/pose.hpp"

namespace crspf {

/// Motion along an arc of length `distance_m` with the heading turning by `turn_rad`, exact and continuous for
/// turn_rad -> 0. All models below are this arc with their own distance and turn. Wait-free.
[[nodiscard]] Pose2 arc(double distance_m, double turn_rad);

/// Differential drive, formulas (1) and (2): distance (L + R) / 2, turn (R - L) / B.
/// @param left_m,right_m [m] rolled by each wheel  @param wheel_span_m [m] B > 0
[[nodiscard]] Pose2 differential_motion(double left_m, double right_m, double wheel_span_m);

/// Car-like vehicle, formula (3): turn V tan(Phi) / L dt, distance V dt.
/// @param steering_rad [rad] |Phi| < pi/2; beyond 80 degrees it is held at 80  @param wheel_base_m [m] L > 0
[[nodiscard]] Pose2 ackermann_motion(double speed_mps, double steering_rad, double wheel_base_m, double dt_s);

/// Vehicle speed with the yaw rate of an IMU (paper 3.3).
[[nodiscard]] Pose2 imu_motion(double speed_mps, double yaw_rate_radps, double dt_s);

}  // namespace crspf
