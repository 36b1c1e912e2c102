#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>

#include "core/base/trig.hpp"
#include "tests/unit/sim/recorder.hpp"
#include "tools/sim/random.hpp"
#include "tools/sim/world3d.hpp"

namespace crspf::sim {

namespace {

constexpr double kHeight_m = 0.5;

Echo look(const World3d& world, Point from, double azimuth_deg, double elevation_deg,
          const std::vector<Circle>& people = {}) {
    const SinCos azimuth = sin_cos(radians(azimuth_deg));
    const SinCos elevation = sin_cos(radians(elevation_deg));
    return world.cast({.x = from.x_m, .y = from.y_m, .z = world.terrain().height_m(from) + kHeight_m},
                      {.x = elevation.cos * azimuth.cos, .y = elevation.cos * azimuth.sin, .z = elevation.sin},
                      {.legs = people}, 100.0);
}

}  // namespace

TEST_CASE("rays meet ground, wall or nothing where geometry says") {
    const World3d world(World(test::box(0.0, 0.0, 20.0, 10.0)), {}, {}, Terrain{});
    const Point here{5.0, 5.0};
    // Along x the ground rises by 1 %: a level ray comes 15 cm nearer to it on 15 m.
    Echo echo = look(world, here, 0.0, 0.0);
    CHECK(echo.surface == Surface::kWall);
    CHECK(echo.range_m == Approx(15.0));
    // Below the horizon: 0.5 m down to where the slope meets the ray.
    echo = look(world, here, 0.0, -5.0);
    CHECK(echo.surface == Surface::kGround);
    const double way_m = kHeight_m / (std::tan(radians(5.0)) + Terrain::kSlopeX);
    CHECK(echo.range_m == Approx(way_m / std::cos(radians(5.0))));
    // Upward: the wall as long as it is high enough, then nothing.
    echo = look(world, here, 0.0, 7.0);
    CHECK(echo.surface == Surface::kWall);
    CHECK(echo.range_m == Approx(15.0 / std::cos(radians(7.0))));
    CHECK(look(world, here, 0.0, 9.0).surface == Surface::kNothing);
    CHECK(look(world, here, 180.0, 15.0).surface == Surface::kWall);
}

TEST_CASE("a kerb is seen from its side and from above, a person up to his head") {
    const World3d world(World(test::box(0.0, 0.0, 20.0, 10.0)), {{.lower = {8.0, 4.0}, .upper = {10.0, 6.0}}}, {},
                        Terrain{});
    const Point here{6.0, 5.0};
    Echo echo = look(world, here, 0.0, -12.0);  // at 2 m it is 0.5 - 0.43 - 0.02 m above the ground
    CHECK(echo.surface == Surface::kKerb);
    CHECK(echo.range_m * std::cos(radians(12.0)) == Approx(2.0));
    echo = look(world, here, 0.0, -9.0);
    CHECK(echo.surface == Surface::kKerb);
    const double way_m = (kHeight_m - World3d::kKerbHeight_m) / (std::tan(radians(9.0)) + Terrain::kSlopeX);
    CHECK(echo.range_m * std::cos(radians(9.0)) == Approx(way_m));
    CHECK(look(world, here, 0.0, -3.0).surface == Surface::kGround);  // behind the island
    CHECK(look(world, here, 90.0, -12.0).surface == Surface::kGround);

    const std::vector<Circle> people{{.centre = {6.0, 9.0}, .radius_m = 0.1}};
    CHECK(look(world, here, 90.0, 15.0, people).range_m * std::cos(radians(15.0)) == Approx(3.9));
    CHECK(look(world, here, 90.0, 15.0, people).surface == Surface::kPerson);
    CHECK(look(world, here, 90.0, 19.5, people).surface == Surface::kWall);
}

TEST_CASE("on uneven ground rays meet what they would meet step by step") {
    const Scene field = make_scene("field");
    const World3d world(field, Terrain(radians(12.0)));
    Random random(11, RandomStream::kTest);
    int grounds = 0;
    int kerbs = 0;
    int walls = 0;
    int crowns = 0;
    for (int n = 0; n < 4000; ++n) {
        const Point from{random.uniform(2.0, 58.0), random.uniform(2.0, 42.0)};
        if (world.obstacles().clearance(from, 1.0) < 0.5) {
            continue;
        }
        const SinCos azimuth = sin_cos(random.uniform(-kPi, kPi));
        const SinCos elevation = sin_cos(radians(random.uniform(-25.0, 25.0)));
        const Vector3 origin{.x = from.x_m, .y = from.y_m, .z = world.terrain().height_m(from) + kHeight_m};
        const Vector3 direction{.x = elevation.cos * azimuth.cos, .y = elevation.cos * azimuth.sin, .z = elevation.sin};
        const Echo echo = world.cast(origin, direction, {}, 30.0);
        const double way_m = echo.surface == Surface::kNothing ? 30.0 : echo.range_m;
        // Nothing before it ...
        constexpr double kStep_m = 0.02;
        double least_m = 1.0;
        for (int step = 0; (step + 1) * kStep_m < way_m; ++step) {
            const Vector3 p = origin + (step * kStep_m) * direction;
            const double above_m = p.z - world.terrain().height_m({p.x, p.y});
            least_m = std::min(least_m, above_m);
            const bool on_island = std::any_of(world.islands().begin(), world.islands().end(), [&](const Island& i) {
                return p.x > i.lower.x_m && p.x < i.upper.x_m && p.y > i.lower.y_m && p.y < i.upper.y_m;
            });
            REQUIRE_FALSE((on_island && above_m < World3d::kKerbHeight_m - 1e-6));
            const bool in_crown = std::any_of(field.crowns.begin(), field.crowns.end(), [&](const Crown& c) {
                return distance({p.x, p.y}, c.circle.centre) < c.circle.radius_m - 1e-6 && above_m > c.low_m + 0.1 &&
                       above_m < c.high_m;
            });
            REQUIRE_FALSE(in_crown);
        }
        REQUIRE(least_m > -1e-6);
        // ... and there, what is said.
        const Vector3 hit = origin + way_m * direction;
        const double above_m = hit.z - world.terrain().height_m({hit.x, hit.y});
        if (echo.surface == Surface::kGround) {
            REQUIRE(above_m == Approx(0.0).margin(5e-4));  // a quarter of what a lidar resolves
            ++grounds;
        } else if (echo.surface == Surface::kWall) {
            REQUIRE(field.world.clearance({hit.x, hit.y}, 1.0) < 1e-6);
            REQUIRE(above_m <= World3d::kWallHeight_m);
            ++walls;
        } else if (echo.surface == Surface::kKerb) {
            REQUIRE(above_m <= World3d::kKerbHeight_m + 1e-6);
            ++kerbs;
        } else if (echo.surface == Surface::kCrown) {
            REQUIRE(above_m >= 1.6);
            ++crowns;
        }
    }
    CHECK(std::min({grounds, walls}) > 500);
    CHECK(std::min({kerbs, crowns}) > 3);
}

TEST_CASE("a crown is seen from beside and from below, and passed under") {
    const Crown crown{.circle = {.centre = {10.0, 5.0}, .radius_m = 2.0}, .low_m = 1.7, .high_m = 4.0};
    const World3d world(World(test::box(0.0, 0.0, 20.0, 10.0)), {}, {crown}, Terrain{});
    const Point here{4.0, 5.0};
    CHECK(look(world, here, 0.0, 2.0).surface == Surface::kWall);    // under it
    CHECK(look(world, here, 0.0, 20.0).surface == Surface::kCrown);  // its side, 4 m ahead
    CHECK(look(world, here, 0.0, 20.0).range_m * std::cos(radians(20.0)) == Approx(4.0));
    const Echo below = look(world, here, 0.0, 13.0);
    CHECK(below.surface == Surface::kCrown);
    CHECK(below.range_m * std::cos(radians(13.0)) == Approx(1.2 / (std::tan(radians(13.0)) - Terrain::kSlopeX)));
    CHECK(look(world, here, 0.0, 45.0).surface == Surface::kNothing);  // over it
    CHECK(look(world, here, 90.0, 10.0).surface == Surface::kWall);
}

TEST_CASE("a scene gets islands where there is room, and the robot keeps off them") {
    const Scene hall = make_scene("hall");
    const World3d world(hall, Terrain{});
    REQUIRE(world.islands().size() == 4);
    CHECK(World3d(make_scene("corridor"), Terrain{}).islands().empty());
    for (const Island& i : world.islands()) {
        const Point corner = i.lower;
        CHECK(hall.world.clearance(corner, 5.0) > 0.5 * 1.9);
        CHECK(world.obstacles().clearance(corner, 5.0) == Approx(0.0).margin(1e-9));
    }

    // In a room that an island half fills, no way leads past it at a distance.
    const Scene room = test::room(8.0, 6.0);
    const World3d filled(room, Terrain{});
    REQUIRE(filled.islands().size() == 1);
    test::Recorder recorder;
    SimulationParams params = test::ideal();
    params.lidar = lidar_model("velodyne");
    params.duration_s = 25.0;
    const SimulationResult result = test::run(room, params, recorder);
    CHECK(result.driven_m > 5.0);
    double nearest_kerb_m = 1.0;
    for (const TimedPose& pose : result.truth) {
        const Point p{pose.P_map_base.x_m, pose.P_map_base.y_m};
        const double clear_m = filled.obstacles().clearance(p, 1.0);
        REQUIRE(clear_m > 0.95 * params.robot.radius_m);
        if (clear_m < room.world.clearance(p, 1.0)) {
            nearest_kerb_m = std::min(nearest_kerb_m, clear_m);
        }
    }
    CHECK(nearest_kerb_m < 0.6);
}

TEST_CASE("exponential numbers have the mean, the median and the variance of their kind") {
    Random random(1, RandomStream::kTest);
    constexpr int kDraws = 100000;
    double sum = 0.0;
    double squares = 0.0;
    int below_median = 0;
    for (int i = 0; i < kDraws; ++i) {
        const double x = random.exponential();
        REQUIRE(x >= 0.0);
        sum += x;
        squares += x * x;
        below_median += x < std::log(2.0) ? 1 : 0;
    }
    CHECK(sum / kDraws == Approx(1.0).margin(0.02));
    CHECK(squares / kDraws == Approx(2.0).margin(0.1));
    CHECK(below_median == Approx(kDraws / 2).margin(1000));
}

}  // namespace crspf::sim
