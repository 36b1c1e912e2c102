// Cars that drive along a road, in both directions, each a body with a cabin to the lidar.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "tools/sim/random.hpp"
#include "tools/sim/world.hpp"

namespace crspf::sim {

class Cars {
 public:
    static constexpr double kLength_m = 4.5;
    static constexpr double kWidth_m = 1.8;
    static constexpr double kHeight_m = 1.5;
    /// A lane lies to either side of the middle of the road, on which the robot drives: so far that they pass a car of
    /// this width in the bends, and so near that they pass those that are parked.
    static constexpr double kLane_m = 2.7;

    /// `count` cars on a road that leads round to its beginning, in turn on its right lane and on its left, where they
    /// come the other way; none within 15 m of the robot. Throws InputError where the road has no room for so many.
    Cars(std::span<const Point> road, std::size_t count, Point robot, std::uint64_t seed);

    /// They drive for `seconds`. A car brakes for a bend, for the car ahead and for whatever else is in its way, and
    /// drives on when that has gone.
    void advance(double seconds, std::span<const Circle> others);

    /// As a lidar sees them: two for each.
    [[nodiscard]] std::span<const Box> boxes() const { return boxes_; }
    /// As a driver sees them, who keeps off discs.
    [[nodiscard]] std::span<const Circle> discs() const { return discs_; }

 private:
    struct LanePoint {
        Point place;
        SinCos heading{.sin = 0.0, .cos = 1.0};
        double limit_mps = 0.0;  ///< so that a bend is not too fast
    };
    /// Points at equal steps, the last one a step from the first.
    using Lane = std::vector<LanePoint>;

    struct Car {
        std::size_t lane = 0;
        double at_m = 0.0;  ///< along it
        double cruising_mps = 0.0;
        double speed_mps = 0.0;
    };

    [[nodiscard]] static Lane lane_of(std::span<const Point> road, double right_m, bool backward);
    [[nodiscard]] static double length_m(const Lane& lane);
    [[nodiscard]] static Box body_at(const Lane& lane, double at_m);
    [[nodiscard]] double gap_m(const Car& car) const;
    [[nodiscard]] bool in_the_way(const Car& car, double ahead_m, std::span<const Circle> others) const;
    void drive(Car& car, double seconds, std::span<const Circle> others);
    void place(std::size_t car);

    std::array<Lane, 2> lanes_;
    Random random_;
    std::vector<Car> cars_;
    std::vector<Box> boxes_;
    std::vector<Circle> discs_;
};

}  // namespace crspf::sim
