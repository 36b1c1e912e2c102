// The pose that the motion controller gets: now, smooth, and not valid any longer rather than wrong.
#pragma once

#include <utility>

#include "config/service_config.hpp"
#include "drivers/can/pose_frames.hpp"
#include "platform/crspfd/exchange.hpp"

namespace crspf {

/// Never reset.
struct PoseComposerCounters {
    std::uint64_t poses = 0;
    std::uint64_t lost = 0;   ///< of these, those that are not to be steered by
    std::uint64_t jumps = 0;  ///< corrections too large to be let in slowly, and placings of the robot
};

/// P_map_base = P_map_odom * P_odom_base (REP-105): the odometry's part is extrapolated by its speed to the asked
/// instant; corrections of P_map_odom are let in at a limited speed. One owner; wait-free, no heap, no throw.
class PoseComposer {
 public:
    explicit PoseComposer(PoseOutputConfig config) : config_(std::move(config)) {}

    /// @param now not before the last call's
    PoseReport compose(Stamp now, const OdometryState& odometry, const FilterState& filter);

    [[nodiscard]] const PoseComposerCounters& counters() const { return counters_; }

 private:
    void follow(const Pose2& P_map_odom, const Pose2& P_odom_base, double dt_s, bool placed);

    PoseOutputConfig config_;
    Pose2 P_map_odom_;  ///< as sent
    bool begun_ = false;
    Stamp last_;
    std::uint8_t odometry_jumps_ = 0;
    std::uint8_t resets_ = 0;
    PoseComposerCounters counters_;
};

}  // namespace crspf
