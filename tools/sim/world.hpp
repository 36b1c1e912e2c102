// The world as the lidar sees it: opaque wall segments, exact to the rounding of a double.
#pragma once

#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "core/base/trig.hpp"

namespace crspf::sim {

/// The way of a ray that meets nothing. [m]
inline constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// A point of the world frame. [m]
struct Point {
    double x_m = 0.0;
    double y_m = 0.0;
};

[[nodiscard]] double distance(Point a, Point b);

struct Segment {
    Point a;
    Point b;
};

/// Something round that moves: a leg to the lidar, a person to the robot.
struct Circle {
    Point centre;
    double radius_m = 0.0;
};

/// A body of a car that moves, seen from above.
struct Box {
    Point centre;
    SinCos heading{.sin = 0.0, .cos = 1.0};
    double half_length_m = 0.0;
    double half_width_m = 0.0;
    double height_m = 0.0;  ///< of its top above the ground, on which it stands

    /// A point of the world, as seen from the box: x along it, y to its left.
    [[nodiscard]] Point seen(Point p) const;
    /// From a point to the nearest of the box, 0 inside. [m]
    [[nodiscard]] double away_m(Point p) const;
};

/// What moves, as a lidar meets it at one moment.
struct Movers {
    std::span<const Circle> legs{};
    std::span<const Box> cars{};
};

/// Distance at which the ray meets the circle, infinity if it does not. A ray from inside meets it at 0.
[[nodiscard]] double cast_on_circle(Point origin, SinCos direction, const Circle& circle);

/// The part of a ray, by its way, within something.
struct Part {
    double from_m = 0.0;
    double to_m = kInfinity;

    [[nodiscard]] bool empty() const { return !(from_m < to_m); }
    /// Where one coordinate lies between two bounds.
    void cut(double origin, double rate, double low, double high);
};

[[nodiscard]] Part part_over(Point origin, SinCos direction, const Box& box);
[[nodiscard]] Part part_over(Point origin, SinCos direction, const Circle& circle);

/// What a ray meets.
struct Hit {
    double range_m = kInfinity;
    std::uint32_t wall = 0;  ///< index into walls(), where the range is finite
};

/// A set of walls, sorted into a grid of bins so that a ray looks only at the walls along its way.
class World {
 public:
    explicit World(std::vector<Segment> walls);

    /// Distance along the ray to the nearest wall, infinity if there is none within `range_max_m`.
    /// From outside lower() to upper() nothing is seen: robots and people live inside.
    [[nodiscard]] double cast(Point origin, SinCos direction, double range_max_m) const {
        return hit(origin, direction, range_max_m).range_m;
    }
    /// The same, with the wall.
    [[nodiscard]] Hit hit(Point origin, SinCos direction, double range_max_m) const;

    /// Distance from a point to the nearest wall, at most `limit_m`.
    [[nodiscard]] double clearance(Point p, double limit_m) const;

    [[nodiscard]] const std::vector<Segment>& walls() const { return walls_; }
    /// Corners of a box round all walls, 1 m wider on each side.
    [[nodiscard]] Point lower() const { return lower_; }
    [[nodiscard]] Point upper() const { return upper_; }

 private:
    [[nodiscard]] int column(double x_m) const;
    [[nodiscard]] int row(double y_m) const;
    [[nodiscard]] std::size_t bin(int column, int row) const;
    template <typename Visit>
    void for_each_bin_of(const Segment& wall, Visit visit) const;

    std::vector<Segment> walls_;
    Point lower_;
    Point upper_;
    int columns_ = 0;
    int rows_ = 0;
    std::vector<std::uint32_t> bin_begin_;  ///< of bin i in bin_walls_; one more than there are bins
    std::vector<std::uint32_t> bin_walls_;  ///< indices into walls_
};

}  // namespace crspf::sim
