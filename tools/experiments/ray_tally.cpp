#include "tools/experiments/ray_tally.hpp"

#include <algorithm>
#include <cmath>

namespace crspf::experiments {
namespace {

/// By the wall that the beam meets first.
std::size_t incidence_of(const sim::World& world, sim::Point eye, sim::Point hit) {
    const double away_m = sim::distance(eye, hit);
    const SinCos ray{.sin = (hit.y_m - eye.y_m) / away_m, .cos = (hit.x_m - eye.x_m) / away_m};
    const sim::Hit met = world.hit(eye, ray, away_m + 1.0);
    if (!(met.range_m < sim::kInfinity)) {
        return kIncidences - 1;  // by a hair past the end of a wall
    }
    const sim::Segment& wall = world.walls()[met.wall];
    const double length_m = std::max(sim::distance(wall.a, wall.b), 1e-9);
    const double along = std::abs(ray.cos * (wall.b.x_m - wall.a.x_m) + ray.sin * (wall.b.y_m - wall.a.y_m)) / length_m;
    constexpr double kSin30 = 0.5;
    constexpr double kSin60 = 0.8660254037844386;
    return along < kSin30 ? 0 : along < kSin60 ? 1 : 2;
}

}  // namespace

void RayTally::add(const ScanPoints& points, const RayFinder& finder, const Pose2& P_world_base) {
    ++count_.scans;
    const Pose2 eye_pose = P_world_base * points.P_base_first_lidar;
    const sim::Point eye{eye_pose.x_m, eye_pose.y_m};
    bool in_corner = false;
    bool found = false;
    for (std::uint32_t i = 0; i < points.count; ++i) {
        const Pose2 at =
            P_world_base * Pose2{.x_m = static_cast<double>(points.x_m[i]), .y_m = static_cast<double>(points.y_m[i])};
        const sim::Point hit{at.x_m, at.y_m};
        const bool critical = finder.critical(i);
        const bool at_corner = corners_.seen_near(hit, kAtCorner_m, eye);
        ++count_.hits;
        count_.critical += critical ? 1 : 0;
        count_.hits_at_corner += at_corner ? 1 : 0;
        count_.critical_at_corner += critical && at_corner ? 1 : 0;
        if (!at_corner) {
            const std::size_t incidence = incidence_of(world_, eye, hit);
            ++count_.plain[incidence];
            count_.wrong[incidence] += critical ? 1 : 0;
        } else if (!in_corner) {
            ++count_.corners_in_view;
            found = false;
        }
        if (at_corner && critical && !found) {
            ++count_.corners_found;
            found = true;
        }
        in_corner = at_corner;
    }
}

}  // namespace crspf::experiments
