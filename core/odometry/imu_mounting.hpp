// How an IMU of six axes is turned against the vehicle, and what it says in the vehicle's axes.
#pragma once

#include "core/base/samples.hpp"
#include "core/base/trig.hpp"
#include "core/odometry/odometry_params.hpp"

namespace crspf {

/// No heap, no throw, constant time.
class ImuMounting {
 public:
    explicit ImuMounting(const OdometryParams& params)
        : roll_(sin_cos(params.imu_roll_rad)),
          pitch_(sin_cos(params.imu_pitch_rad)),
          yaw_(sin_cos(params.imu_yaw_rad)),
          tilted_(params.imu_roll_rad != 0.0 || params.imu_pitch_rad != 0.0) {}

    /// Its z axis is not the vehicle's: of its yaw rate alone nothing can be made.
    [[nodiscard]] bool tilted() const { return tilted_; }

    /// Rates and accelerations in the vehicle's axes; a sample of a yaw rate alone stays as it is.
    void to_base(ImuSample& sample) const {
        if (!sample.inertial) {
            return;
        }
        Inertial& i = *sample.inertial;
        to_base(i.roll_rate_radps, i.pitch_rate_radps, sample.yaw_rate_radps);
        to_base(i.acceleration_x_mps2, i.acceleration_y_mps2, i.acceleration_z_mps2);
    }

 private:
    /// From a to b, by the angle.
    static void turn(const SinCos& angle, double& a, double& b) {
        const double before = a;
        a = angle.cos * before - angle.sin * b;
        b = angle.sin * before + angle.cos * b;
    }
    void to_base(double& x, double& y, double& z) const {
        if (tilted_) {  // else z stays, whatever a damaged x and y say
            turn(roll_, y, z);
            turn(pitch_, z, x);
        }
        turn(yaw_, x, y);
    }

    SinCos roll_;
    SinCos pitch_;
    SinCos yaw_;
    bool tilted_;
};

}  // namespace crspf
