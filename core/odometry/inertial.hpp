// An IMU of six axes: which way is up, and how fast the heading turns, whatever the vehicle's tilt (paper 3.3; the
// attitude is beyond the paper, for the LRF update on rough ground).
#pragma once

#include <cstdint>
#include <optional>

#include "core/base/samples.hpp"
#include "core/odometry/attitude.hpp"
#include "core/odometry/standing.hpp"

namespace crspf {

/// Never reset.
struct InertialCounters {
    std::uint64_t samples = 0;
    std::uint64_t damaged = 0;  ///< NaN, or beyond any sensor's range; left out
    std::uint64_t gaps = 0;     ///< more than 0.2 s without a sample: up is found anew from the accelerations
    std::uint64_t stuck = 0;    ///< on the move all axes told the same for the twentieth time or more; left out
};

/// A complementary filter: the gyroscope turns the estimate of up, and the specific force, less what driving causes of
/// it, pulls it back with a time constant of kPull_s. What pulls always to one side is the gyroscope's bias. While the
/// vehicle stands, the gyroscope tells its bias itself.
/// No heap, no throw, constant time; one owner.
class InertialFilter {
 public:
    static constexpr double kPull_s = 4.0;

    /// What is left of the sample for the plane: rate of the heading, speed over ground. `sample.inertial` must be
    /// there. The yaw rate's bias is not this filter's: Odometry learns it for every IMU.
    [[nodiscard]] ImuSample add(const ImuSample& sample);

    /// Of the last sample, by its accelerations: how fast the speed changes, along the vehicle's x. None where they
    /// were left out.
    [[nodiscard]] const std::optional<double>& forward_mps2() const { return forward_mps2_; }
    [[nodiscard]] const AttitudeHistory& attitude() const { return attitude_; }
    /// Of roll and pitch rate. [rad/s]
    [[nodiscard]] const Vector3& bias_radps() const { return bias_radps_; }
    [[nodiscard]] const InertialCounters& counters() const { return counters_; }

 private:
    [[nodiscard]] bool is_usable(const ImuSample& sample);
    void turn(const Vector3& rate_radps, double dt_s);
    void pull(const Vector3& force_mps2, const Vector3& rate_radps, const ImuSample& sample, double dt_s);
    [[nodiscard]] static ImuSample in_plane(const ImuSample& sample, const Vector3& rate_radps, const Vector3& up);

    AttitudeHistory attitude_;
    Vector3 up_ = kLevel;
    Vector3 bias_radps_;
    InertialCounters counters_;

    bool started_ = false;
    double known_s_ = 0.0;  ///< for so long, at most kPull_s: the pull is as strong as that of a mean
    Stamp stamp_;           ///< of the sample before
    Vector3 rate_radps_;    ///< then
    Inertial raw_;
    std::uint32_t same_ = 0;  ///< samples equal to it
    double speed_mps_ = 0.0;  ///< smoothed, for the acceleration
    double acceleration_mps2_ = 0.0;
    std::optional<double> forward_mps2_;
    Standing standing_;
};

}  // namespace crspf
