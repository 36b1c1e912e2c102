#include "tools/sim/world.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace crspf::sim {
namespace {

constexpr double kBin_m = 0.5;
constexpr double kMargin_m = 1.0;
// Walls are made this much longer, and bins this much larger, so that no ray slips between two that touch.
constexpr double kTouch_m = 1e-6;

double cast_on_segment(Point origin, SinCos direction, const Segment& wall) {
    const double ex = wall.b.x_m - wall.a.x_m;
    const double ey = wall.b.y_m - wall.a.y_m;
    const double ax = wall.a.x_m - origin.x_m;
    const double ay = wall.a.y_m - origin.y_m;
    const double cross = direction.cos * ey - direction.sin * ex;
    if (std::abs(cross) < 1e-12) {
        return kInfinity;  // a wall seen edge-on: its neighbours end the ray
    }
    const double along_ray = (ax * ey - ay * ex) / cross;
    const double along_wall = (ax * direction.sin - ay * direction.cos) / cross;
    constexpr double kTolerance = 1e-9;
    const bool hit = along_ray >= 0.0 && along_wall >= -kTolerance && along_wall <= 1.0 + kTolerance;
    if (!hit) {
        return kInfinity;
    }
    return along_ray;
}

double distance_to_segment(Point p, const Segment& wall) {
    const double ex = wall.b.x_m - wall.a.x_m;
    const double ey = wall.b.y_m - wall.a.y_m;
    const double px = p.x_m - wall.a.x_m;
    const double py = p.y_m - wall.a.y_m;
    const double length2 = ex * ex + ey * ey;
    const double u = length2 > 0.0 ? std::clamp((px * ex + py * ey) / length2, 0.0, 1.0) : 0.0;
    return distance(p, {wall.a.x_m + u * ex, wall.a.y_m + u * ey});
}

}  // namespace

double distance(Point a, Point b) {
    const double dx = b.x_m - a.x_m;
    const double dy = b.y_m - a.y_m;
    return std::sqrt(dx * dx + dy * dy);
}

double cast_on_circle(Point origin, SinCos direction, const Circle& circle) {
    const double cx = circle.centre.x_m - origin.x_m;
    const double cy = circle.centre.y_m - origin.y_m;
    const double c = cx * cx + cy * cy - circle.radius_m * circle.radius_m;
    if (c <= 0.0) {
        return 0.0;
    }
    const double b = cx * direction.cos + cy * direction.sin;
    const double discriminant = b * b - c;
    return b < 0.0 || discriminant < 0.0 ? kInfinity : b - std::sqrt(discriminant);
}

void Part::cut(double origin, double rate, double low, double high) {
    if (rate == 0.0) {
        to_m = origin >= low && origin <= high ? to_m : -kInfinity;
        return;
    }
    const double a = (low - origin) / rate;
    const double b = (high - origin) / rate;
    from_m = std::max(from_m, std::min(a, b));
    to_m = std::min(to_m, std::max(a, b));
}

Point Box::seen(Point p) const {
    const double x_m = p.x_m - centre.x_m;
    const double y_m = p.y_m - centre.y_m;
    return {heading.cos * x_m + heading.sin * y_m, heading.cos * y_m - heading.sin * x_m};
}

Part part_over(Point origin, SinCos direction, const Box& box) {
    const Point from = box.seen(origin);
    Part part;
    part.cut(from.x_m, direction.cos * box.heading.cos + direction.sin * box.heading.sin, -box.half_length_m,
             box.half_length_m);
    part.cut(from.y_m, direction.sin * box.heading.cos - direction.cos * box.heading.sin, -box.half_width_m,
             box.half_width_m);
    return part;
}

Part part_over(Point origin, SinCos direction, const Circle& circle) {
    const double x_m = circle.centre.x_m - origin.x_m;
    const double y_m = circle.centre.y_m - origin.y_m;
    const double along_m = direction.cos * x_m + direction.sin * y_m;
    const double beside_m = direction.cos * y_m - direction.sin * x_m;
    const double half_square = circle.radius_m * circle.radius_m - beside_m * beside_m;
    if (half_square < 0.0) {
        return {.from_m = 0.0, .to_m = -kInfinity};
    }
    const double half_m = std::sqrt(half_square);
    return {.from_m = std::max(along_m - half_m, 0.0), .to_m = along_m + half_m};
}

double Box::away_m(Point p) const {
    const Point at = seen(p);
    const Point beyond{std::max(std::abs(at.x_m) - half_length_m, 0.0), std::max(std::abs(at.y_m) - half_width_m, 0.0)};
    return distance({}, beyond);
}

World::World(std::vector<Segment> walls) : walls_(std::move(walls)) {
    lower_ = {kInfinity, kInfinity};
    upper_ = {-kInfinity, -kInfinity};
    for (const Segment& wall : walls_) {
        for (const Point p : {wall.a, wall.b}) {
            lower_ = {std::min(lower_.x_m, p.x_m), std::min(lower_.y_m, p.y_m)};
            upper_ = {std::max(upper_.x_m, p.x_m), std::max(upper_.y_m, p.y_m)};
        }
    }
    if (walls_.empty()) {
        lower_ = upper_ = {};
    }
    lower_ = {lower_.x_m - kMargin_m, lower_.y_m - kMargin_m};
    upper_ = {upper_.x_m + kMargin_m, upper_.y_m + kMargin_m};
    columns_ = column(upper_.x_m) + 1;
    rows_ = row(upper_.y_m) + 1;

    // Counting sort of (bin, wall) pairs: count, running sum, fill.
    bin_begin_.assign(static_cast<std::size_t>(columns_) * static_cast<std::size_t>(rows_) + 1, 0);
    for (const Segment& wall : walls_) {
        for_each_bin_of(wall, [&](std::size_t b) { ++bin_begin_[b + 1]; });
    }
    for (std::size_t b = 1; b < bin_begin_.size(); ++b) {
        bin_begin_[b] += bin_begin_[b - 1];
    }
    bin_walls_.resize(bin_begin_.back());
    std::vector<std::uint32_t> fill(bin_begin_.begin(), bin_begin_.end() - 1);
    for (std::size_t i = 0; i < walls_.size(); ++i) {
        for_each_bin_of(walls_[i], [&](std::size_t b) { bin_walls_[fill[b]++] = static_cast<std::uint32_t>(i); });
    }
}

int World::column(double x_m) const {
    return static_cast<int>(std::floor((x_m - lower_.x_m) / kBin_m));
}

int World::row(double y_m) const {
    return static_cast<int>(std::floor((y_m - lower_.y_m) / kBin_m));
}

std::size_t World::bin(int column, int row) const {
    return static_cast<std::size_t>(row) * static_cast<std::size_t>(columns_) + static_cast<std::size_t>(column);
}

// Bins that the wall crosses: of those its box covers, the ones that lie on both sides of its line.
template <typename Visit>
void World::for_each_bin_of(const Segment& wall, Visit visit) const {
    const int left = column(std::min(wall.a.x_m, wall.b.x_m) - kTouch_m);
    const int right = column(std::max(wall.a.x_m, wall.b.x_m) + kTouch_m);
    const int bottom = row(std::min(wall.a.y_m, wall.b.y_m) - kTouch_m);
    const int top = row(std::max(wall.a.y_m, wall.b.y_m) + kTouch_m);
    const double nx = wall.a.y_m - wall.b.y_m;
    const double ny = wall.b.x_m - wall.a.x_m;
    const double reach = (0.5 * kBin_m + kTouch_m) * (std::abs(nx) + std::abs(ny));
    for (int r = bottom; r <= top; ++r) {
        for (int c = left; c <= right; ++c) {
            const double x_m = lower_.x_m + (c + 0.5) * kBin_m;
            const double y_m = lower_.y_m + (r + 0.5) * kBin_m;
            if (std::abs(nx * (x_m - wall.a.x_m) + ny * (y_m - wall.a.y_m)) <= reach) {
                visit(bin(c, r));
            }
        }
    }
}

Hit World::hit(Point origin, SinCos direction, double range_max_m) const {
    int c = column(origin.x_m);
    int r = row(origin.y_m);
    const int step_c = direction.cos < 0.0 ? -1 : 1;
    const int step_r = direction.sin < 0.0 ? -1 : 1;
    const double per_column = direction.cos != 0.0 ? kBin_m / std::abs(direction.cos) : kInfinity;
    const double per_row = direction.sin != 0.0 ? kBin_m / std::abs(direction.sin) : kInfinity;
    // Distance along the ray to the next border between columns, and between rows.
    const double into_c = (origin.x_m - lower_.x_m) / kBin_m - c;
    const double into_r = (origin.y_m - lower_.y_m) / kBin_m - r;
    double to_column = direction.cos != 0.0 ? (step_c > 0 ? 1.0 - into_c : into_c) * per_column : kInfinity;
    double to_row = direction.sin != 0.0 ? (step_r > 0 ? 1.0 - into_r : into_r) * per_row : kInfinity;

    Hit nearest;
    while (c >= 0 && r >= 0 && c < columns_ && r < rows_) {
        const std::size_t b = bin(c, r);
        for (std::uint32_t i = bin_begin_[b]; i < bin_begin_[b + 1]; ++i) {
            const double range_m = cast_on_segment(origin, direction, walls_[bin_walls_[i]]);
            if (range_m < nearest.range_m) {
                nearest = {range_m, bin_walls_[i]};
            }
        }
        const double leaves_bin_m = std::min(to_column, to_row);
        if (nearest.range_m <= leaves_bin_m || leaves_bin_m > range_max_m) {
            break;  // what lies in bins further on is further away
        }
        if (to_column < to_row) {
            c += step_c;
            to_column += per_column;
        } else {
            r += step_r;
            to_row += per_row;
        }
    }
    return nearest.range_m > range_max_m ? Hit{} : nearest;
}

double World::clearance(Point p, double limit_m) const {
    const int left = std::max(column(p.x_m - limit_m), 0);
    const int right = std::min(column(p.x_m + limit_m), columns_ - 1);
    const int bottom = std::max(row(p.y_m - limit_m), 0);
    const int top = std::min(row(p.y_m + limit_m), rows_ - 1);
    double nearest_m = limit_m;
    for (int r = bottom; r <= top; ++r) {
        for (int c = left; c <= right; ++c) {
            const std::size_t b = bin(c, r);
            for (std::uint32_t i = bin_begin_[b]; i < bin_begin_[b + 1]; ++i) {
                nearest_m = std::min(nearest_m, distance_to_segment(p, walls_[bin_walls_[i]]));
            }
        }
    }
    return nearest_m;
}

}  // namespace crspf::sim
