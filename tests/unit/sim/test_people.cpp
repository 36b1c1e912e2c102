#include <algorithm>
#include <catch2/catch.hpp>

#include "tests/unit/sim/recorder.hpp"
#include "tools/sim/nav_grid.hpp"
#include "tools/sim/people.hpp"

namespace crspf::sim {

TEST_CASE("people walk, and never into a robot that stands in their way") {
    const World world(test::box(0.0, 0.0, 12.0, 2.2));
    const Circle robot{.centre = {6.0, 1.1}, .radius_m = 0.2};
    const NavGrid floor(world, robot.centre, 0.25);
    People people(floor, 6, robot.centre, 4);
    const std::vector<Circle> before = people.bodies();
    double nearest_m = 1e9;
    double nearest_leg_m = 1e9;
    double walked_m = 0.0;
    for (int step = 0; step < 3000; ++step) {
        const Circle one_before = people.bodies()[0];
        people.advance(0.02, robot);
        walked_m += distance(one_before.centre, people.bodies()[0].centre);
        for (const Circle& body : people.bodies()) {
            nearest_m = std::min(nearest_m, distance(body.centre, robot.centre) - body.radius_m - robot.radius_m);
        }
        for (const Circle& leg : people.legs()) {
            nearest_leg_m = std::min(nearest_leg_m, distance(leg.centre, robot.centre) - leg.radius_m - robot.radius_m);
        }
    }
    CHECK(walked_m > 10.0);
    CHECK(nearest_m > 0.0);
    CHECK(nearest_leg_m > 0.0);
    CHECK(nearest_m < 1.0);  // they did come by
}

TEST_CASE("a ray meets the legs of a person") {
    const World world(test::box(0.0, 0.0, 12.0, 12.0));
    const NavGrid floor(world, {1.0, 1.0}, 0.25);
    const People people(floor, 1, {1.0, 1.0}, 4);
    REQUIRE(people.legs().size() == 2);
    for (const Circle& leg : people.legs()) {
        CHECK(distance(leg.centre, people.bodies()[0].centre) < 0.3);
    }
    LidarModel model = test::ideal().lidar;
    model.range_max_m = 30.0;
    Lidar lidar(model, 1);
    const Circle& leg = people.legs()[0];
    const Pose2 before_it{.x_m = leg.centre.x_m - 0.5, .y_m = leg.centre.y_m, .theta_rad = 0.0};
    CHECK(lidar.read_mm(world, {.legs = people.legs()}, before_it, 340) <= 440);
    CHECK(lidar.read_mm(world, {}, before_it, 340) > 440);
}

}  // namespace crspf::sim
