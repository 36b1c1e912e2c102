#include "tools/experiments/corners.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

namespace crspf::experiments {
namespace {

constexpr double kTouch_m = 0.001;
constexpr double kSinSharp = 0.5;       // of 30 degrees
constexpr double kHidden_m = 0.03;      // what stands so far before a corner hides it
constexpr double kDegenerate_m = 1e-9;  // a wall without length

/// A wall as a point and a direction of length 1.
struct Line {
    explicit Line(const sim::Segment& wall) : from(wall.a), length_m(sim::distance(wall.a, wall.b)) {
        if (length_m > kDegenerate_m) {
            dx = (wall.b.x_m - wall.a.x_m) / length_m;
            dy = (wall.b.y_m - wall.a.y_m) / length_m;
        }
    }
    [[nodiscard]] bool reaches(double along_m) const { return along_m > -kTouch_m && along_m < length_m + kTouch_m; }
    /// From a point of the plane to the nearest of the wall.
    [[nodiscard]] double away_m(sim::Point p) const {
        const double along_m = std::clamp((p.x_m - from.x_m) * dx + (p.y_m - from.y_m) * dy, 0.0, length_m);
        return sim::distance(p, {from.x_m + along_m * dx, from.y_m + along_m * dy});
    }

    sim::Point from;
    double length_m;
    double dx = 0.0;
    double dy = 0.0;
};

/// Where two walls meet, sharply enough.
std::optional<sim::Point> bend(const Line& a, const Line& b) {
    const double sine = a.dx * b.dy - a.dy * b.dx;
    if (std::abs(sine) < kSinSharp) {
        return std::nullopt;
    }
    const double x = b.from.x_m - a.from.x_m;
    const double y = b.from.y_m - a.from.y_m;
    const double along_a = (x * b.dy - y * b.dx) / sine;
    const double along_b = (x * a.dy - y * a.dx) / sine;
    if (!a.reaches(along_a) || !b.reaches(along_b)) {
        return std::nullopt;
    }
    return sim::Point{a.from.x_m + along_a * a.dx, a.from.y_m + along_a * a.dy};
}

}  // namespace

Corners::Corners(const sim::World& world) : world_(world) {
    const std::vector<Line> lines(world.walls().begin(), world.walls().end());
    for (std::size_t i = 0; i < lines.size(); ++i) {
        for (std::size_t j = i + 1; j < lines.size(); ++j) {
            if (const std::optional<sim::Point> p = bend(lines[i], lines[j])) {
                add(*p);
            }
        }
        for (const sim::Point end : {world.walls()[i].a, world.walls()[i].b}) {
            const auto touching =
                std::count_if(lines.begin(), lines.end(), [end](const Line& l) { return l.away_m(end) < kTouch_m; });
            if (touching == 1) {  // the wall itself
                add(end);
            }
        }
    }
}

void Corners::add(sim::Point p) {
    if (std::none_of(points_.begin(), points_.end(), [p](sim::Point q) { return sim::distance(p, q) < kTouch_m; })) {
        points_.push_back(p);
    }
}

bool Corners::seen_near(sim::Point p, double within_m, sim::Point eye) const {
    return std::any_of(points_.begin(), points_.end(), [&](sim::Point corner) {
        if (sim::distance(p, corner) > within_m) {
            return false;
        }
        const double away_m = sim::distance(eye, corner);
        const SinCos direction{.sin = (corner.y_m - eye.y_m) / away_m, .cos = (corner.x_m - eye.x_m) / away_m};
        return world_.cast(eye, direction, away_m) > away_m - kHidden_m;
    });
}

}  // namespace crspf::experiments
