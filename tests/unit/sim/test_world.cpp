#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <limits>

#include "core/base/trig.hpp"
#include "tests/unit/sim/recorder.hpp"
#include "tools/sim/map_walls.hpp"
#include "tools/sim/nav_grid.hpp"
#include "tools/sim/random.hpp"
#include "tools/sim/scene.hpp"
#include "tools/sim/world.hpp"

namespace crspf::sim {

namespace {}

TEST_CASE("a ray in a room meets the wall that the closed form tells") {
    const World world(test::box(-3.0, -2.0, 4.0, 5.0));
    const Point origin{0.7, 1.1};
    for (int i = 0; i < 3600; ++i) {
        const SinCos d = sin_cos(radians(0.1 * i));
        const double to_x = d.cos > 0   ? (4.0 - origin.x_m) / d.cos
                            : d.cos < 0 ? (-3.0 - origin.x_m) / d.cos
                                        : kInfinity;
        const double to_y = d.sin > 0   ? (5.0 - origin.y_m) / d.sin
                            : d.sin < 0 ? (-2.0 - origin.y_m) / d.sin
                                        : kInfinity;
        REQUIRE(world.cast(origin, d, 100.0) == Approx(std::min(to_x, to_y)).epsilon(1e-12));
    }
}

TEST_CASE("no ray slips through a corner") {
    const World world(test::box(-1.0, -1.0, 1.0, 1.0));
    for (const double x : {-1.0, 1.0}) {
        for (const double y : {-1.0, 1.0}) {
            const double length = std::sqrt(2.0);
            CHECK(world.cast({0.0, 0.0}, {.sin = y / length, .cos = x / length}, 10.0) == Approx(length));
        }
    }
}

TEST_CASE("a slanting wall is met where the line equations say") {
    const World world(std::vector<Segment>{{{2.0, -3.0}, {4.0, 3.0}}, {{-1.0, 0.5}, {-1.0, 0.6}}});
    // x = 3 + y / 3 and y = x tan(a)
    for (const double deg : {-30.0, -10.0, 0.0, 15.0, 35.0}) {
        const SinCos d = sin_cos(radians(deg));
        CHECK(world.cast({0.0, 0.0}, d, 100.0) == Approx(3.0 / (d.cos - d.sin / 3.0)));
    }
    CHECK(world.cast({0.0, 0.0}, sin_cos(kPi), 100.0) == kInfinity);
    CHECK(world.cast({-100.0, 0.0}, sin_cos(0.0), 200.0) == kInfinity);  // from outside nothing is seen
}

TEST_CASE("walls beyond the range are not seen") {
    const World world(test::box(0.0, 0.0, 10.0, 10.0));
    CHECK(world.cast({5.0, 5.0}, sin_cos(0.0), 4.999) == kInfinity);
    CHECK(world.cast({5.0, 5.0}, sin_cos(0.0), 5.001) == Approx(5.0));
}

TEST_CASE("the bins change nothing: a ray finds what a look at every wall finds") {
    const Scene scene = make_scene("office");
    Random random(7, RandomStream::kTest);
    int hits = 0;
    for (int i = 0; i < 300; ++i) {
        const Point origin{random.uniform(0.1, 29.9), random.uniform(0.1, 19.9)};
        const SinCos direction = sin_cos(random.uniform(-kPi, kPi));
        double nearest = kInfinity;
        double clearance = 2.0;
        for (const Segment& wall : scene.world.walls()) {
            // A wall alone; the two far ones make its bins reach as far as the office.
            const World alone(std::vector<Segment>{wall, {{-9.0, -9.0}, {-9.0, -8.0}}, {{39.0, 29.0}, {39.0, 28.0}}});
            nearest = std::min(nearest, alone.cast(origin, direction, 40.0));
            clearance = std::min(clearance, alone.clearance(origin, 2.0));
        }
        REQUIRE(scene.world.cast(origin, direction, 40.0) == Approx(nearest));
        REQUIRE(scene.world.clearance(origin, 2.0) == Approx(clearance));
        hits += nearest < kInfinity ? 1 : 0;
    }
    CHECK(hits == 300);  // the office has no holes
}

TEST_CASE("a ray meets a circle where the closed form tells") {
    const Circle circle{.centre = {3.0, 0.0}, .radius_m = 0.5};
    CHECK(cast_on_circle({0.0, 0.0}, sin_cos(0.0), circle) == Approx(2.5));
    CHECK(cast_on_circle({0.0, 0.3}, sin_cos(0.0), circle) == Approx(3.0 - 0.4));
    CHECK(cast_on_circle({0.0, 0.6}, sin_cos(0.0), circle) == kInfinity);
    CHECK(cast_on_circle({0.0, 0.0}, sin_cos(kPi), circle) == kInfinity);
    CHECK(cast_on_circle({3.1, 0.1}, sin_cos(1.0), circle) == 0.0);
}

TEST_CASE("doors in the corridor lie 5 cm back") {
    const Scene scene = make_scene("corridor");
    const SinCos right = sin_cos(-kPi / 2.0);
    const SinCos left = sin_cos(kPi / 2.0);
    CHECK(scene.world.cast({3.0, 1.1}, right, 5.0) == Approx(1.10));
    CHECK(scene.world.cast({1.45, 1.1}, right, 5.0) == Approx(1.15));
    CHECK(scene.world.cast({1.45, 1.1}, left, 5.0) == Approx(1.10));
    CHECK(scene.world.cast({3.0, 1.1}, left, 5.0) == Approx(1.15));
    CHECK(scene.world.cast({1.0, 1.1}, sin_cos(0.0), 100.0) == Approx(79.0));
    CHECK(scene.world.cast({1.0, 1.1}, sin_cos(kPi), 100.0) == Approx(1.0));
}

TEST_CASE("the lobby: a corridor of 45 m opens into a hall, from which another of 25 m leads north") {
    const Scene scene = make_scene("lobby");
    const SinCos east = sin_cos(0.0);
    const SinCos north = sin_cos(kPi / 2.0);
    CHECK(scene.world.cast({1.0, 1.2}, north, 100.0) == Approx(1.2));
    CHECK(scene.world.cast({1.0, 1.2}, sin_cos(kPi), 100.0) == Approx(1.0));
    CHECK(scene.world.cast({1.0, 0.3}, east, 100.0) > 45.0);
    CHECK(scene.world.cast({47.0, 0.0}, north, 100.0) == Approx(9.8));
    CHECK(scene.world.cast({59.5, -4.5}, north, 100.0) == Approx(39.9));
    CHECK(scene.world.cast({59.5, 11.0}, east, 100.0) == Approx(1.1));
}

TEST_CASE("the arena: within 4.57 m x 4.04 m, and a robot of 0.2 m radius gets into each of its 25 places") {
    const Scene scene = make_scene("arena");
    CHECK(scene.world.upper().x_m - scene.world.lower().x_m == Approx(4.57 + 2.0));
    CHECK(scene.world.upper().y_m - scene.world.lower().y_m == Approx(4.04 + 2.0));
    const NavGrid floor(scene.world, {scene.P_world_start.x_m, scene.P_world_start.y_m}, 0.2);
    for (const double x_m : {0.43, 1.32, 2.24, 3.17, 4.1}) {
        for (const double y_m : {0.4, 1.21, 2.02, 2.81, 3.62}) {
            CAPTURE(x_m, y_m);
            CHECK(floor.reachable({x_m, y_m}));
        }
    }
}

TEST_CASE("what is not free in a map is solid, and so is its edge") {
    GridMap map{.width = 4, .height = 3, .resolution_m = 0.5, .P_map_origin = {.x_m = 10.0, .y_m = 20.0}, .cells = {}};
    map.cells.assign(12, GridCell::kFree);
    map.cells[1 * 4 + 2] = GridCell::kOccupied;  // column 2, row 1
    map.cells[1 * 4 + 0] = GridCell::kUnknown;
    const World world(walls_of(map));
    const Point in_cell_1_1{10.75, 20.75};
    CHECK(world.cast(in_cell_1_1, sin_cos(0.0), 10.0) == Approx(0.25));
    CHECK(world.cast(in_cell_1_1, sin_cos(kPi), 10.0) == Approx(0.25));
    CHECK(world.cast(in_cell_1_1, sin_cos(kPi / 2.0), 10.0) == Approx(0.75));
    CHECK(world.cast({10.25, 20.25}, sin_cos(0.0), 10.0) == Approx(1.75));
}

TEST_CASE("walls of a turned map turn with it") {
    GridMap map{.width = 2,
                .height = 2,
                .resolution_m = 1.0,
                .P_map_origin = {.x_m = 0.0, .y_m = 0.0, .theta_rad = kPi / 4.0},
                .cells = {}};
    map.cells.assign(4, GridCell::kFree);
    const World world(walls_of(map));
    const Point centre{0.0, std::sqrt(2.0)};
    CHECK(world.cast(centre, sin_cos(kPi / 2.0), 10.0) == Approx(std::sqrt(2.0)));
    CHECK(world.cast(centre, sin_cos(kPi / 4.0), 10.0) == Approx(1.0));
}

TEST_CASE("the most open place is the middle of the larger room") {
    GridMap map{.width = 12, .height = 5, .resolution_m = 1.0, .P_map_origin = {}, .cells = {}};
    map.cells.assign(60, GridCell::kFree);
    for (int row = 0; row < 5; ++row) {
        map.cells[static_cast<std::size_t>(row) * 12 + 4] = GridCell::kOccupied;
    }
    const Point place = most_open_place(map);
    CHECK(place.x_m > 7.0);
    CHECK(place.x_m < 10.0);
    CHECK(place.y_m == Approx(2.5));
}

TEST_CASE("the true map is free inside, occupied at the walls and unknown beyond") {
    const GridMap map = rasterize(World(test::box(0.0, 0.0, 2.0, 1.0)), {1.0, 0.5}, 0.1);
    const auto at = [&](double x, double y) {
        return map.at(static_cast<int>(std::floor((x - map.P_map_origin.x_m) / 0.1)),
                      static_cast<int>(std::floor((y - map.P_map_origin.y_m) / 0.1)));
    };
    CHECK(at(1.0, 0.5) == GridCell::kFree);
    CHECK(at(0.15, 0.85) == GridCell::kFree);
    CHECK(at(1.0, 1.05) == GridCell::kOccupied);
    CHECK(at(2.05, 0.5) == GridCell::kOccupied);
    CHECK(at(1.0, 1.35) == GridCell::kUnknown);
    CHECK(at(-0.5, 0.5) == GridCell::kUnknown);
}

TEST_CASE("the generator's numbers are spread as they should be") {
    Random random(3, RandomStream::kTest);
    constexpr int kCount = 100000;
    double sum = 0.0;
    double squares = 0.0;
    double uniforms = 0.0;
    for (int i = 0; i < kCount; ++i) {
        const double n = random.normal();
        sum += n;
        squares += n * n;
        uniforms += random.uniform();
    }
    CHECK(sum / kCount == Approx(0.0).margin(0.015));
    CHECK(squares / kCount == Approx(1.0).margin(0.02));
    CHECK(uniforms / kCount == Approx(0.5).margin(0.005));
    CHECK(Random(3, RandomStream::kTest).next() == Random(3, RandomStream::kTest).next());
    CHECK(Random(3, RandomStream::kTest).next() != Random(3, RandomStream::kLidar).next());
    CHECK(Random(3, RandomStream::kTest).next() != Random(4, RandomStream::kTest).next());
}

}  // namespace crspf::sim
