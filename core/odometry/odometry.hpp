// Odometry (paper Section 3): any odometer's samples become the observed pose P~, with a bounded history so that a
// scan finds P~ at its own stamp, and a correction from the particle filter finds whatever has come in since.
//
// P~(t) = P_map_odom * P_odom_base(t). The odometer moves P_odom_base only, which is smooth and drifts; a correction
// moves P_map_odom only (REP-105). Applying P(t) P~(t)^-1 to the current pose is then one product.
#pragma once

#include <array>
#include <cstdint>
#include <optional>

#include "config/capacities.hpp"
#include "core/base/pose.hpp"
#include "core/base/samples.hpp"
#include "core/base/trig.hpp"
#include "core/odometry/attitude.hpp"
#include "core/odometry/imu_mounting.hpp"
#include "core/odometry/inertial.hpp"
#include "core/odometry/odometry_params.hpp"
#include "core/odometry/speed_estimate.hpp"
#include "core/odometry/standing.hpp"

namespace crspf {

/// What was not used, and why. Never reset.
struct OdometryCounters {
    std::uint64_t samples = 0;
    std::uint64_t not_finite = 0;      ///< NaN or infinite
    std::uint64_t ran_back = 0;        ///< stamp before the newest one
    std::uint64_t gaps = 0;            ///< more than 1 s since the sample before: its speed was not integrated across
    std::uint64_t implausible = 0;     ///< more than 10 m or half a turn in one sample, or a variance below 0
    std::uint64_t askew = 0;           ///< of an IMU mounted askew not all axes were told
    std::uint64_t out_of_history = 0;  ///< a pose was asked for that is older than the history
};

/// Motion between two instants, with what the odometer's error may have grown to meanwhile.
struct MotionPrior {
    Pose2 P_from_to;
    double translation_stddev_m = 0.0;  ///< [m] along and across
    double rotation_stddev_rad = 0.0;   ///< [rad]
    double told_stddev_m = 0.0;         ///< [m] along and across: what of it the odometer itself has told
};

/// All methods: no heap, no throw, bounded time; one owner (not thread-safe).
class Odometry {
 public:
    explicit Odometry(const OdometryParams& params)
        : params_(params), imu_(params), bias_radps_(params.yaw_rate_bias_radps) {}

    void add(const DifferentialSample& sample);
    void add(const AckermannSample& sample);
    void add(const ImuSample& sample);
    void add(const MotionSample& sample);

    /// Places the robot: P~ is `P_map_base` now, whatever the odometer said before.
    void set_pose(const Pose2& P_map_base);

    /// The newest observed pose P~.
    [[nodiscard]] Pose2 pose() const { return P_map_odom_ * newest().P_odom_base; }
    /// P~ at `stamp`: interpolated in the history; held at its ends (extrapolated by the last speed for at most 0.2 s).
    [[nodiscard]] Pose2 pose_at(Stamp stamp) const { return P_map_odom_ * state_at(stamp).P_odom_base; }
    /// Motion of base_link between two stamps, and its uncertainty. What an odometer says of its own doubt comes on top
    /// of what the parameters give, not in its place: it does not know how wrong its scale and its stamps are.
    [[nodiscard]] MotionPrior motion_between(Stamp from, Stamp to) const;

    /// The filter found P(t) = `P_map_base` for `stamp`: from now on P~ is corrected by P(t) P~(t)^-1. Corrections that
    /// turn always to one side are an IMU's yaw rate bias; the way from one P(t) to the next is the speed of a vehicle
    /// that tells none.
    void correct(Stamp stamp, const Pose2& P_map_base);

    [[nodiscard]] const Pose2& P_map_odom() const { return P_map_odom_; }
    [[nodiscard]] const OdometryCounters& counters() const { return counters_; }
    /// By an IMU of six axes; level without one.
    [[nodiscard]] const AttitudeHistory& attitude() const { return inertial_.attitude(); }
    [[nodiscard]] const InertialCounters& inertial_counters() const { return inertial_.counters(); }
    /// What an IMU's yaw rate says while the heading stays. [rad/s]
    [[nodiscard]] double yaw_rate_bias_radps() const { return bias_radps_; }
    /// Of a vehicle that tells none. [m/s]
    [[nodiscard]] double estimated_speed_mps() const { return speed_.speed_mps(); }

 private:
    struct State {
        Stamp stamp;
        Pose2 P_odom_base;
        double travelled_m = 0.0;  ///< path length so far
        double turned_rad = 0.0;   ///< sum of all turns' absolute values
        double felt_m = 0.0;       ///< way by the accelerations alone, where no speed is told
        double doubt_m2 = 0.0;     ///< sum of the variances that the odometer itself tells
        double doubt_rad2 = 0.0;   ///< the same of the heading
    };

    [[nodiscard]] const State& newest() const { return history_[newest_]; }
    [[nodiscard]] State state_at(Stamp stamp) const;
    [[nodiscard]] bool usable_interval(Stamp stamp, double& dt_s);
    void advance(const MotionSample& motion, double felt_m = 0.0);
    void learn_standing(const ImuSample& sample, double dt_s);
    void learn_moving(Stamp stamp, double corrected_rad);
    void learn_speed(Stamp stamp, const Pose2& P_map_base);

    [[nodiscard]] AckermannSample at_rear_axle(const AckermannSample& sample) const;
    [[nodiscard]] ImuSample in_base(const ImuSample& sample) const;

    OdometryParams params_;
    ImuMounting imu_;
    Pose2 P_map_odom_;
    std::array<State, capacity::kMotionHistory> history_{};
    std::size_t newest_ = 0;
    std::size_t count_ = 0;
    AckermannSample held_ackermann_{};
    ImuSample held_imu_{};

    InertialFilter inertial_;
    double bias_radps_;
    Standing standing_;
    Stamp corrected_;                       ///< last; the beginning of time: not yet
    std::optional<Pose2> P_map_corrected_;  ///< then; none: placed since
    bool speed_told_ = true;                ///< by the newest sample of an IMU, or there was none
    SpeedEstimate speed_;
    mutable OdometryCounters counters_;
};

}  // namespace crspf
