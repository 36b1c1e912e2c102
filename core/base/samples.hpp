// The plain types that every layer speaks: what a sensor said, in metres, seconds and radians, with its stamp.
#pragma once

#include <array>
#include <cstdint>
#include <optional>

#include "config/capacities.hpp"
#include "core/base/pose.hpp"
#include "core/base/time.hpp"

namespace crspf {

/// Distance that each driven wheel rolled since the sample before (paper 3.1, formulas (1) and (2)).
struct DifferentialSample {
    Stamp stamp;           ///< end of the interval
    double left_m = 0.0;   ///< [m] forward positive
    double right_m = 0.0;  ///< [m] forward positive
};

/// Speed and steering of a car-like vehicle (paper 3.1, formula (3)); held until the next sample.
struct AckermannSample {
    Stamp stamp;
    double speed_mps = 0.0;     ///< [m/s] of the driven wheel, forward positive
    double steering_rad = 0.0;  ///< [rad] left positive
};

/// What an IMU of six axes says beside its yaw rate, in the vehicle's axes: x forward, y left, z up (REP-103).
struct Inertial {
    double roll_rate_radps = 0.0;   ///< [rad/s] about x
    double pitch_rate_radps = 0.0;  ///< [rad/s] about y
    // Specific force: standing on level ground, z is 9.81. [m/s^2]
    double acceleration_x_mps2 = 0.0;
    double acceleration_y_mps2 = 0.0;
    double acceleration_z_mps2 = 0.0;
};

/// Yaw rate and vehicle speed (paper 3.3); held until the next sample.
struct ImuSample {
    Stamp stamp;
    double yaw_rate_radps = 0.0;         ///< [rad/s] counter-clockwise positive; about the vehicle's z
    double speed_mps = 0.0;              ///< [m/s] forward positive; along the vehicle's x
    std::optional<Inertial> inertial{};  ///< none: the vehicle is taken to be level
    bool speed_told = true;              ///< false: nobody tells it, speed_mps is 0, and the scans have to show it
};

/// A finished increment of motion from any other odometer: visual odometry, or a log that holds integrated poses.
struct MotionSample {
    Stamp stamp;            ///< end of the interval
    Pose2 P_previous_base;  ///< base_link now, seen from base_link at the sample before
    // By which the odometer itself says that it may be off; 0: it does not say.
    double translation_variance_m2 = 0.0;  ///< [m^2] along and across, each
    double rotation_variance_rad2 = 0.0;   ///< [rad^2]
    bool blind = false;                    ///< it measured nothing: the motion is what it predicts
};

/// What one beam of a scan says.
enum class Beam : std::uint8_t {
    kInvalid,   ///< nothing: an error code, too near, dazzled, masked. Neither free nor occupied.
    kNoReturn,  ///< no echo: the sensor saw nothing up to its range. Free, as far as the configuration trusts it.
    kHit,       ///< an obstacle at range_m
    kClear,     ///< no obstacle up to range_m, where what is known ends; free as far as that
};

/// One revolution or sweep of a planar lidar, in the lidar frame, counter-clockwise (angle_increment_rad > 0).
/// A sensor that turns clockwise or hangs upside down is turned round by whoever fills this struct.
struct Scan {
    Stamp stamp;                                    ///< when beam 0 was measured
    double time_per_beam_s = 0.0;                   ///< [s] from a beam to the next; 0 where unknown: no de-skew
    double angle_min_rad = 0.0;                     ///< [rad] of beam 0; 0 is forward
    double angle_increment_rad = 0.0;               ///< [rad]
    std::uint32_t count = 0;                        ///< beams in use, at most capacity::kBeams
    std::array<float, capacity::kBeams> range_m{};  ///< [m] of kHit and kClear
    std::array<Beam, capacity::kBeams> beam{};
};

}  // namespace crspf
