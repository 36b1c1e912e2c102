#include "core/slam/place_check.hpp"

#include <algorithm>
#include <array>
#include <cstddef>

#include "core/base/real.hpp"

namespace crspf {

PlaceCheck::PlaceCheck(const MapView& map, const SparseScan& scan, double tolerance_m)
    : map_(map),
      scan_(scan),
      cells_per_metre_(1.0 / map.resolution_m),
      reach_(static_cast<std::int32_t>(std::clamp(tolerance_m / map.resolution_m + 0.5, 1.0, 16.0))) {}

double PlaceCheck::share(const Pose2& P_corner_lidar) const {
    const std::int32_t all = (reach_ + 1) * static_cast<std::int32_t>(scan_.count);
    const std::int32_t explained = sum(P_corner_lidar, [this](Point from, Point hit) { return can_see(from, hit); });
    return all > 0 ? static_cast<double>(explained) / static_cast<double>(all) : 0.0;
}

PlaceCheck::Climbed PlaceCheck::climb(const Pose2& P_corner_lidar, double step_m, double step_rad) const {
    constexpr int kHalvings = 3;
    const auto hits_at = [this](const Pose2& P) { return sum(P, [](Point, Point) { return true; }); };
    Climbed best{.P_corner_lidar = P_corner_lidar, .evaluations = 1};
    std::int32_t best_sum = hits_at(P_corner_lidar);
    for (int halved = 0; halved < kHalvings && best.evaluations < kClimbEvaluations;) {
        const Pose2 from = best.P_corner_lidar;
        const std::array<Pose2, 6> around{{{from.x_m + step_m, from.y_m, from.theta_rad},
                                           {from.x_m - step_m, from.y_m, from.theta_rad},
                                           {from.x_m, from.y_m + step_m, from.theta_rad},
                                           {from.x_m, from.y_m - step_m, from.theta_rad},
                                           {from.x_m, from.y_m, wrap_angle(from.theta_rad + step_rad)},
                                           {from.x_m, from.y_m, wrap_angle(from.theta_rad - step_rad)}}};
        bool higher = false;
        for (const Pose2& next : around) {
            const std::int32_t next_sum = hits_at(next);
            ++best.evaluations;
            if (next_sum > best_sum) {
                best.P_corner_lidar = next;
                best_sum = next_sum;
                higher = true;
            }
        }
        if (!higher) {
            step_m *= 0.5;
            step_rad *= 0.5;
            ++halved;
        }
    }
    return best;
}

template <typename Counts>
std::int32_t PlaceCheck::sum(const Pose2& P_corner_lidar, Counts&& counts) const {
    const SinCos r = sin_cos(P_corner_lidar.theta_rad);
    const Point from{.x = P_corner_lidar.x_m * cells_per_metre_, .y = P_corner_lidar.y_m * cells_per_metre_};
    std::int32_t total = 0;
    for (std::uint32_t i = 0; i < scan_.count; ++i) {
        const double x = static_cast<double>(scan_.x_m[i]) * cells_per_metre_;
        const double y = static_cast<double>(scan_.y_m[i]) * cells_per_metre_;
        const Point hit{.x = from.x + (r.cos * x - r.sin * y), .y = from.y + (r.sin * x + r.cos * y)};
        const std::int32_t worth = worth_at(hit);
        if (worth > 0 && counts(from, hit)) {
            total += worth;
        }
    }
    return total;
}

std::int32_t PlaceCheck::worth_at(Point hit) const {
    const std::int32_t hit_x = floor_to_cell(hit.x);
    const std::int32_t hit_y = floor_to_cell(hit.y);
    std::int32_t best = 0;
    for (std::int32_t y = std::max(hit_y - reach_, 0); y <= std::min(hit_y + reach_, map_.height - 1); ++y) {
        const Evidence* const row = map_.cells.data() + std::ptrdiff_t{y} * map_.width;
        const std::int32_t ring_y = y < hit_y ? hit_y - y : y - hit_y;
        for (std::int32_t x = std::max(hit_x - reach_, 0); x <= std::min(hit_x + reach_, map_.width - 1); ++x) {
            if (row[x] >= kOccupiedFrom) {
                const std::int32_t ring_x = x < hit_x ? hit_x - x : x - hit_x;
                best = std::max(best, reach_ + 1 - std::max(ring_x, ring_y));
            }
        }
    }
    return best;
}

bool PlaceCheck::can_see(Point from, Point to) const {
    const double length = square_root(square(to.x - from.x) + square(to.y - from.y));
    const double aside = length > 0.0 ? reach_ / length : 0.0;
    const std::array<double, 3> sides{0.0, aside, -aside};
    return std::any_of(sides.begin(), sides.end(), [&](double side) {
        const double x = -side * (to.y - from.y);
        const double y = side * (to.x - from.x);
        return is_open({.x = from.x + x, .y = from.y + y}, {.x = to.x + x, .y = to.y + y});
    });
}

bool PlaceCheck::is_open(Point from, Point to) const {
    // Up to a little before the hit, where its own wall may begin: about what a ray at 20 degrees runs within the
    // tolerance of it.
    const double before_hit = 3.0 * reach_;
    const double length = square_root(square(to.x - from.x) + square(to.y - from.y));
    const auto end = static_cast<std::int32_t>(length - before_hit);
    std::int32_t unseen = 0;
    for (std::int32_t k = 0; k < end; ++k) {
        const double u = static_cast<double>(k) / length;
        const std::int32_t x = floor_to_cell(from.x + u * (to.x - from.x));
        const std::int32_t y = floor_to_cell(from.y + u * (to.y - from.y));
        const Evidence evidence = map_.at(x, y);
        if (evidence >= kOccupiedFrom) {
            return false;
        }
        unseen += evidence == kUnseen ? 1 : 0;
    }
    return 2 * unseen <= end;
}

}  // namespace crspf
