// With what the built-in worlds are drawn.
#pragma once

#include <utility>
#include <vector>

#include "core/base/pose.hpp"
#include "core/base/trig.hpp"
#include "tools/sim/scene.hpp"
#include "tools/sim/world.hpp"

namespace crspf::sim {

inline constexpr double kTruthResolution_m = 0.025;

/// Draws walls. Where two solids overlap, the segments inside are out of everybody's sight.
class Drawing {
 public:
    void line(const std::vector<Point>& points) {
        for (std::size_t i = 1; i < points.size(); ++i) {
            walls_.push_back({points[i - 1], points[i]});
        }
    }

    /// Axis-aligned box between two corners.
    void box(double x0, double y0, double x1, double y1) { line({{x0, y0}, {x1, y0}, {x1, y1}, {x0, y1}, {x0, y0}}); }

    /// Box of the given size round its centre, turned.
    void turned_box(Point centre, double length_m, double width_m, double turn_deg) {
        const SinCos r = sin_cos(radians(turn_deg));
        const auto corner = [&](double u, double v) {
            const double x = u * length_m / 2.0;
            const double y = v * width_m / 2.0;
            return Point{centre.x_m + r.cos * x - r.sin * y, centre.y_m + r.sin * x + r.cos * y};
        };
        line({corner(-1, -1), corner(1, -1), corner(1, 1), corner(-1, 1), corner(-1, -1)});
    }

    /// Regular polygon with its corners on a circle.
    void round(Point centre, double radius_m, int sides) {
        std::vector<Point> corners;
        for (int i = 0; i <= sides; ++i) {
            const SinCos s = sin_cos(2.0 * kPi * (i % sides) / sides);
            corners.push_back({centre.x_m + radius_m * s.cos, centre.y_m + radius_m * s.sin});
        }
        line(corners);
    }

    /// A wall along x at height y with niches of the given depth (positive: towards +y) and width, starting at each of
    /// `niches`: closed doors, seen from the side where the depth leads away from.
    void wall_with_niches(double x0, double x1, double y, const std::vector<double>& niches, double width_m,
                          double depth_m) {
        std::vector<Point> points{{x0, y}};
        for (const double x : niches) {
            points.insert(points.end(), {{x, y}, {x, y + depth_m}, {x + width_m, y + depth_m}, {x + width_m, y}});
        }
        points.push_back({x1, y});
        line(points);
    }

    /// The same along y at the line x.
    void wall_y_with_niches(double y0, double y1, double x, const std::vector<double>& niches, double width_m,
                            double depth_m) {
        std::vector<Point> points{{x, y0}};
        for (const double y : niches) {
            points.insert(points.end(), {{x, y}, {x + depth_m, y}, {x + depth_m, y + width_m}, {x, y + width_m}});
        }
        points.push_back({x, y1});
        line(points);
    }

    /// A thick wall along x round the line y, open at the doors [from, to], which are in ascending order.
    void thick_wall_x(double x0, double x1, double y, const std::vector<std::pair<double, double>>& doors) {
        for (const auto& [from, to] : doors) {
            box(x0, y - kThick_m / 2.0, from, y + kThick_m / 2.0);
            x0 = to;
        }
        box(x0, y - kThick_m / 2.0, x1, y + kThick_m / 2.0);
    }

    /// The same along y round the line x.
    void thick_wall_y(double y0, double y1, double x, const std::vector<std::pair<double, double>>& doors) {
        for (const auto& [from, to] : doors) {
            box(x - kThick_m / 2.0, y0, x + kThick_m / 2.0, from);
            y0 = to;
        }
        box(x - kThick_m / 2.0, y0, x + kThick_m / 2.0, y1);
    }

    /// Four legs.
    void table(Point centre, double length_m, double width_m) {
        for (const double u : {-0.5, 0.5}) {
            for (const double v : {-0.5, 0.5}) {
                turned_box({centre.x_m + u * length_m, centre.y_m + v * width_m}, 0.06, 0.06, 0.0);
            }
        }
    }

    [[nodiscard]] World world() const { return World(walls_); }

 private:
    static constexpr double kThick_m = 0.15;
    std::vector<Segment> walls_;
};

/// The drawing with a true map of the given resolution.
[[nodiscard]] Scene finish(const Drawing& drawing, const Pose2& P_world_start, std::vector<Point> tour,
                           double resolution_m = kTruthResolution_m);

}  // namespace crspf::sim
