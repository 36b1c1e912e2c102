// The vehicle: how it moves in truth, and what its wheel encoders and its firmware make of that.
#pragma once

#include <cstdint>

#include "core/base/pose.hpp"
#include "tools/sim/random.hpp"

namespace crspf::sim {

enum class Drive : std::uint8_t { kDifferential, kAckermann };

/// base_link lies midway between the two driven wheels, which carry the encoders; the body is a disc round it.
struct RobotParams {
    Drive drive = Drive::kDifferential;
    double radius_m = 0.2;                  ///< [m] of the body
    double speed_mps = 0.5;                 ///< [m/s] cruising
    double turn_rate_radps = 0.7854;        ///< [rad/s] largest
    double acceleration_mps2 = 0.8;         ///< [m/s^2] speeding up and braking
    double turn_acceleration_radps2 = 4.0;  ///< [rad/s^2] differential only
    double turning_radius_m = 0.5;          ///< [m] Ackermann only: tightest
    double steering_radpms = 4.0;           ///< [1/(m s)] Ackermann only: largest change of curvature
    double wheel_span_m = 0.33;             ///< [m] between the driven wheels
    double wheel_base_m = 0.35;             ///< [m] Ackermann only: between the axles
    double wheel_radius_m = 0.077;          ///< [m] as the firmware believes
    double counts_per_turn = 2000.0;        ///< [counts]
    double odom_scale_error = 0.0;          ///< both wheels count this fraction too much
    double odom_bias = 0.0;                 ///< the right wheel counts this fraction more than the left
    double slip = 0.005;                    ///< [m/sqrt(m)] each wheel's random error
    double height_m = 1.0;                  ///< [m] what hangs higher is driven under
    double lidar_height_m = 0.5;            ///< [m] of a spatial one, above base_link, along the vehicle's own z
    double obstacle_range_m = 20.0;         ///< [m] up to which a spatial lidar's obstacles are told
    double map_resolution_m = 0.02;         ///< [m] that suits what it drives through
    double arrived_m = 0.25;                ///< [m] a place so near has been visited

    [[nodiscard]] double metres_per_count() const;
};

/// The motion along an arc of the given length while turning by `angle_rad`.
[[nodiscard]] Pose2 arc(double length_m, double angle_rad);

struct Command {
    double speed_mps = 0.0;        ///< [m/s] forward positive
    double turn_rate_radps = 0.0;  ///< [rad/s] left positive; an Ackermann robot takes the ratio of the two
};

struct EncoderCounts {
    std::int64_t left = 0;
    std::int64_t right = 0;
};

/// One step of the simulation, in which speed and turn rate are constant.
struct Motion {
    Pose2 P_world_start;
    double speed_mps = 0.0;
    double turn_rate_radps = 0.0;
    double left_counts = 0.0;  ///< [counts] at the start, with the fraction that the encoder does not tell
    double right_counts = 0.0;
    double left_rate = 0.0;  ///< [counts/s]
    double right_rate = 0.0;

    /// True pose of base_link `seconds` after the start.
    [[nodiscard]] Pose2 pose_at(double seconds) const;
    [[nodiscard]] EncoderCounts counts_at(double seconds) const;
};

/// A car of four metres, its lidar on the roof.
[[nodiscard]] RobotParams car();

class Robot {
 public:
    Robot(const RobotParams& params, const Pose2& P_world_start, std::uint64_t seed);

    /// Drives for `seconds` as near to the command as the limits allow.
    /// @param level how far that leads over the map, per metre of the ground's: less than 1 up and down hills
    Motion advance(const Command& command, double seconds, double level = 1.0);

    [[nodiscard]] const Pose2& pose() const { return P_world_base_; }
    [[nodiscard]] double speed_mps() const { return speed_mps_; }
    /// Turn rate divided by speed, where the steering holds it (Ackermann). [rad/m]
    [[nodiscard]] double curvature() const { return curvature_; }
    [[nodiscard]] double driven_m() const { return driven_m_; }

 private:
    RobotParams params_;
    Random random_;
    Pose2 P_world_base_;
    double speed_mps_ = 0.0;
    double turn_rate_radps_ = 0.0;
    double curvature_ = 0.0;
    double left_counts_ = 0.0;
    double right_counts_ = 0.0;
    double driven_m_ = 0.0;
};

/// The robot's firmware: integrates exact arcs from encoder counts, knowing nothing of slip and wrong wheel sizes.
class WheelOdometer {
 public:
    explicit WheelOdometer(const RobotParams& params) : params_(params) {}

    /// `counts` now, `seconds` after the counts before.
    void update(const EncoderCounts& counts, double seconds);

    [[nodiscard]] const Pose2& pose() const { return P_odom_base_; }
    [[nodiscard]] double speed_mps() const { return speed_mps_; }
    [[nodiscard]] double turn_rate_radps() const { return turn_rate_radps_; }

 private:
    RobotParams params_;
    EncoderCounts before_;
    Pose2 P_odom_base_;
    double speed_mps_ = 0.0;
    double turn_rate_radps_ = 0.0;
};

}  // namespace crspf::sim
