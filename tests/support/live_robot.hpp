// A robot that drives in a circle through a little room, in real time: what its lidar and its wheels say.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "config/config.hpp"
#include "core/base/can_frame.hpp"
#include "core/base/pose.hpp"
#include "core/base/trig.hpp"
#include "tests/unit/drivers/scip_bench.hpp"

namespace crspf::test {

inline constexpr double kStill_s = 1.5;
inline constexpr double kSpeed_mps = 0.25;
inline constexpr double kTurn_radps = 0.4;
inline constexpr double kSpan_m = 0.3;
inline constexpr double kCount_m = 1e-4;

/// Stands, then drives in a circle.
inline Pose2 pose_at(double seconds) {
    const double t = std::max(seconds - kStill_s, 0.0);
    const double radius_m = kSpeed_mps / kTurn_radps;
    const double heading_rad = kTurn_radps * t;
    return {.x_m = radius_m * std::sin(heading_rad),
            .y_m = radius_m * (1.0 - std::cos(heading_rad)),
            .theta_rad = wrap_angle(heading_rad)};
}

/// To the walls of a room of 5 m x 4 m with a pillar, and without one corner: it looks alike from nowhere else.
inline double range_m(const Pose2& P, double angle_rad) {
    const double dx = std::cos(P.theta_rad + angle_rad);
    const double dy = std::sin(P.theta_rad + angle_rad);
    double nearest_m = std::min(((dx > 0.0 ? 3.0 : -2.0) - P.x_m) / dx, ((dy > 0.0 ? 2.5 : -1.5) - P.y_m) / dy);
    const double side_m = (1.6 - P.x_m) / dx;
    if (dx > 0.0 && P.y_m + side_m * dy > 1.4) {
        nearest_m = std::min(nearest_m, side_m);
    }
    const double front_m = (1.4 - P.y_m) / dy;
    if (dy > 0.0 && P.x_m + front_m * dx > 1.6) {
        nearest_m = std::min(nearest_m, front_m);
    }
    const double px = 2.0 - P.x_m;
    const double py = -0.5 - P.y_m;
    const double along = px * dx + py * dy;
    const double aside = px * dy - py * dx;
    if (along > 0.0 && std::abs(aside) < 0.2) {
        nearest_m = std::min(nearest_m, along - std::sqrt(0.04 - aside * aside));
    }
    return nearest_m;
}

/// What a revolution that begins at that time reads.
inline void revolution_at(double seconds, std::span<std::uint32_t> step_mm) {
    const ScipSensor sensor = urg_04lx();
    for (std::size_t i = 0; i < step_mm.size(); ++i) {
        const double turn = static_cast<double>(i) / sensor.ares;
        const double angle_rad = 2.0 * kPi * (turn - static_cast<double>(sensor.afrt) / sensor.ares);
        const Pose2 P = pose_at(seconds + turn * sensor.period_s());
        step_mm[i] = static_cast<std::uint32_t>(std::lround(1000.0 * range_m(P, angle_rad)));
    }
}
/// The robot begins anew where the sensor is plugged in.
inline void revolution(std::uint64_t number, std::span<std::uint32_t> step_mm) {
    revolution_at(static_cast<double>(number) * urg_04lx().period_s(), step_mm);
}

inline std::vector<CanFrame> wheels(std::uint64_t tick) {
    const double t = std::max(0.02 * static_cast<double>(tick) - kStill_s, 0.0);
    std::vector<CanFrame> frames(2);
    for (std::size_t side = 0; side < 2; ++side) {
        const double speed_mps = kSpeed_mps + (side == 0 ? -0.5 : 0.5) * kTurn_radps * kSpan_m;
        const auto counts = static_cast<std::int32_t>(speed_mps * t / kCount_m);
        frames[side].id = static_cast<std::uint32_t>(side + 1);
        frames[side].length = 4;
        std::memcpy(frames[side].data.data(), &counts, sizeof counts);
    }
    return frames;
}

inline constexpr std::string_view kMotionAddress = "udp://127.0.0.1:";

/// What a service needs to know of it.
/// @param base the interface of its wheels; or what begins with kMotionAddress, where its motion is told
inline std::string live_robot_toml(const std::string& tty, const std::string& base) {
    const std::string begin =
        "[lidar]\nrange_max_m = 5.6\n\n[odometry]\nwheel_span_m = 0.3\n\n[source.lidar]\ndriver = \"scip\"\nport = \"" +
        tty + "\"\n\n[source.base]\nport = \"" + base + "\"\n";
    if (base.starts_with(kMotionAddress)) {
        return begin + "driver = \"motion\"\n";
    }
    return begin +
           "driver = \"can\"\n"
           "dbc_text = \"\"\"\nBO_ 1 L: 4 X\n SG_ C : 0|32@1- (1,0) [0|0] \\\"\\\" X\n"
           "BO_ 2 R: 4 X\n SG_ C : 0|32@1- (1,0) [0|0] \\\"\\\" X\n\"\"\"\n\n"
           "[source.base.left]\nsignal = \"L.C\"\nscale = 1e-4\n\n"
           "[source.base.right]\nsignal = \"R.C\"\nscale = 1e-4\n";
}

inline Config robot(const std::filesystem::path& line, const std::string& more = {}) {
    return parse_config(more + live_robot_toml(line.string(), "can0"), "robot.toml");
}

}  // namespace crspf::test
