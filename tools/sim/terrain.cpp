#include "tools/sim/terrain.hpp"

#include <array>

#include "core/base/real.hpp"
#include "core/base/trig.hpp"

namespace crspf::sim {
namespace {

struct Length {
    double length_m;
    double heading_deg;
};

// From what shakes a small robot to what it climbs.
constexpr std::array<Length, 6> kWaves = {
    {{3.1, 20.0}, {4.3, 75.0}, {5.2, 130.0}, {6.9, 165.0}, {8.8, 50.0}, {12.7, 105.0}}};

}  // namespace

Terrain::Terrain(double bumps_rad) : steepest_(square_root(square(kSlopeX) + square(kSlopeY))) {
    if (bumps_rad <= 0.0) {
        return;
    }
    const SinCos bump = sin_cos(bumps_rad);
    const double steepness = bump.sin / bump.cos;
    steepest_ += steepness;
    for (const Length& wave : kWaves) {
        const SinCos heading = sin_cos(radians(wave.heading_deg));
        const double per_m = 2.0 * kPi / wave.length_m;
        waves_.push_back({.per_m_x = per_m * heading.cos,
                          .per_m_y = per_m * heading.sin,
                          .amplitude_m = steepness / static_cast<double>(kWaves.size()) / per_m});
    }
}

double Terrain::height_m(Point p) const {
    double height_m = kSlopeX * p.x_m + kSlopeY * p.y_m;
    for (const Wave& wave : waves_) {
        height_m += wave.amplitude_m * sin_cos(wave.per_m_x * p.x_m + wave.per_m_y * p.y_m).sin;
    }
    return height_m;
}

Frame level_frame(const Pose2& P_world_base) {
    const SinCos heading = sin_cos(P_world_base.theta_rad);
    return {.origin = {.x = P_world_base.x_m, .y = P_world_base.y_m, .z = 0.0},
            .x = {.x = heading.cos, .y = heading.sin, .z = 0.0},
            .y = {.x = -heading.sin, .y = heading.cos, .z = 0.0}};
}

Frame frame_on(const Terrain& terrain, const Pose2& P_world_base, double length_m, double width_m) {
    const SinCos heading = sin_cos(P_world_base.theta_rad);
    const auto ground_m = [&](double ahead_m, double left_m) {
        return terrain.height_m({P_world_base.x_m + heading.cos * ahead_m - heading.sin * left_m,
                                 P_world_base.y_m + heading.sin * ahead_m + heading.cos * left_m});
    };
    const double front_m = ground_m(length_m / 2.0, 0.0);
    const double back_m = ground_m(-length_m / 2.0, 0.0);
    const double left_m = ground_m(0.0, width_m / 2.0);
    const double right_m = ground_m(0.0, -width_m / 2.0);
    const auto unit = [](const Vector3& v) { return (1.0 / length(v)) * v; };
    Frame frame;
    frame.origin = {.x = P_world_base.x_m, .y = P_world_base.y_m, .z = 0.25 * (front_m + back_m + left_m + right_m)};
    frame.x = unit({.x = heading.cos, .y = heading.sin, .z = (front_m - back_m) / length_m});
    frame.z = unit(cross(frame.x, {.x = -heading.sin, .y = heading.cos, .z = (left_m - right_m) / width_m}));
    frame.y = cross(frame.z, frame.x);
    return frame;
}

}  // namespace crspf::sim
