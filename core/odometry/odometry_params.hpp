// What the odometry must know of the vehicle, and how far its word is trusted.
#pragma once

namespace crspf {

struct OdometryParams {
    double wheel_span_m = 0.33;  ///< [m] B of formula (2): between the two driven wheels
    double wheel_base_m = 2.5;   ///< [m] L of formula (3): between the axles
    bool front_driven =
        false;  ///< the speed beside a steering angle is that of the steered wheels, not of the rear axle

    // What `crspf calibrate` finds of the vehicle itself.
    double left_wheel_factor = 1.0;    ///< metres rolled by the left wheel for each that it tells
    double right_wheel_factor = 1.0;   ///< the same of the right wheel
    double speed_factor = 1.0;         ///< true speed for each m/s that is told beside a steering angle or a yaw rate
    double steering_offset_rad = 0.0;  ///< [rad] added to the steering angle: driving straight ahead it is 0 then
    double yaw_rate_bias_radps = 0.0;  ///< [rad/s] of an IMU, at the start; from there on it is learnt
    // How an IMU of six axes is mounted, seen from base_link: turned about z, then about the new y, then about the new
    // x (REP-103), which takes a vector from its axes to the vehicle's by Rz(yaw) Ry(pitch) Rx(roll).
    double imu_roll_rad = 0.0;   ///< [rad] its left side up
    double imu_pitch_rad = 0.0;  ///< [rad] its x axis down
    double imu_yaw_rad = 0.0;    ///< [rad] its x axis to the left

    // Standard deviations that grow with the motion. Defaults: a robot on hard floor with encoders on both wheels.
    double translation_per_metre = 0.10;  ///< [m/m] along and across, per metre driven
    // Per radian turned, much: logs and drivers stamp odometry and scans up to half a scan apart.
    double rotation_per_radian = 0.50;  ///< [rad/rad] per radian turned
    double rotation_per_metre = 0.05;   ///< [rad/m] per metre driven
    double translation_floor_m = 0.02;  ///< [m] from one scan to the next, standing still included
    double rotation_floor_rad = 0.01;   ///< [rad] from one scan to the next, standing still included
};

}  // namespace crspf
