// People who walk from one place to another, each a pair of legs to the lidar.
#pragma once

#include <cstdint>
#include <vector>

#include "tools/sim/nav_grid.hpp"
#include "tools/sim/random.hpp"
#include "tools/sim/world.hpp"

namespace crspf::sim {

class People {
 public:
    /// `count` people somewhere on `floor`, which must outlive this, none within 2 m of the robot if there is room.
    People(const NavGrid& floor, std::size_t count, Point robot, std::uint64_t seed);

    /// They walk for `seconds`; whoever would walk into the robot (a disc) walks round it, or else waits and after a
    /// while turns back.
    void advance(double seconds, const Circle& robot);

    [[nodiscard]] const std::vector<Circle>& bodies() const { return bodies_; }
    [[nodiscard]] const std::vector<Circle>& legs() const { return legs_; }

 private:
    struct Person {
        double speed_mps = 0.0;
        SinCos heading{.sin = 0.0, .cos = 1.0};
        std::vector<Point> path;
        std::size_t next = 0;   ///< index into path
        double walked_m = 0.0;  ///< sets the phase of the gait
        double stuck_s = 0.0;   ///< since a point of the path was reached
    };

    void walk(std::size_t person, double seconds, const Circle& robot);
    void place_legs(std::size_t person);

    const NavGrid* floor_;
    Random random_;
    std::vector<Person> people_;
    std::vector<Circle> bodies_;
    std::vector<Circle> legs_;  ///< two for each
};

}  // namespace crspf::sim
