#include "tools/sim/cars.hpp"

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <utility>
#include <vector>

#include "core/base/trig.hpp"
#include "platform/files/input_error.hpp"
#include "tests/unit/sim/recorder.hpp"
#include "tools/sim/lidar_model.hpp"
#include "tools/sim/scene.hpp"
#include "tools/sim/world3d.hpp"

namespace crspf::sim {
namespace {

/// 60 m by 40 m, with round corners.
std::vector<Point> road() {
    std::vector<Point> points;
    const std::vector<Point> middles{{50.0, 10.0}, {50.0, 30.0}, {10.0, 30.0}, {10.0, 10.0}};
    for (std::size_t corner = 0; corner < middles.size(); ++corner) {
        for (int i = 0; i <= 15; ++i) {
            const SinCos at = sin_cos(kPi / 2.0 * (static_cast<double>(corner) - 1.0 + i / 15.0));
            points.push_back({middles[corner].x_m + 8.0 * at.cos, middles[corner].y_m + 8.0 * at.sin});
        }
    }
    points.push_back(points.front());
    return points;
}

/// The nearest that a wall, a pole or a trunk comes to the outline.
double clearance_m(const World& world, const Box& box) {
    constexpr double kEnough_m = 3.0;
    double nearest_m = kEnough_m;
    for (int i = -10; i <= 10; ++i) {
        for (int k = -4; k <= 4; ++k) {
            const double x_m = box.half_length_m * i / 10.0;
            const double y_m = box.half_width_m * k / 4.0;
            nearest_m =
                std::min(nearest_m, world.clearance({box.centre.x_m + box.heading.cos * x_m - box.heading.sin * y_m,
                                                     box.centre.y_m + box.heading.sin * x_m + box.heading.cos * y_m},
                                                    kEnough_m));
        }
    }
    return nearest_m;
}

double nearest_m(const Cars& cars, Point p) {
    double nearest_m = kInfinity;
    for (const Box& box : cars.boxes()) {
        nearest_m = std::min(nearest_m, box.away_m(p));
    }
    return nearest_m;
}

}  // namespace

TEST_CASE("cars drive on both lanes, keep apart, and stop for who stands in their way") {
    const std::vector<Point> round = road();
    Cars cars(round, 10, {-100.0, 0.0}, 3);
    REQUIRE(cars.boxes().size() == 20);
    const Circle robot{.centre = {30.0, 2.0 - Cars::kLane_m}, .radius_m = 0.5};  // on the right lane
    std::vector<double> way_m(10, 0.0);
    double apart_m = kInfinity;
    double off_robot_m = kInfinity;
    const auto drive = [&](double seconds, std::span<const Circle> others) {
        std::fill(way_m.begin(), way_m.end(), 0.0);
        for (int step = 0; step < std::lround(seconds / 0.02); ++step) {
            const std::vector<Box> before(cars.boxes().begin(), cars.boxes().end());
            cars.advance(0.02, others);
            for (std::size_t i = 0; i < way_m.size(); ++i) {
                way_m[i] += distance(before[2 * i].centre, cars.boxes()[2 * i].centre);
                for (std::size_t k = 0; k < i; ++k) {
                    apart_m = std::min(apart_m, distance(cars.boxes()[2 * i].centre, cars.boxes()[2 * k].centre));
                }
            }
            off_robot_m = std::min(off_robot_m, nearest_m(cars, robot.centre) - robot.radius_m);
        }
    };
    drive(60.0, {});
    CHECK(*std::min_element(way_m.begin(), way_m.end()) > 60.0);
    CHECK(*std::max_element(way_m.begin(), way_m.end()) < 420.0);
    CHECK(apart_m > Cars::kWidth_m + 1.0);  // side by side

    // None is there now, or the test would begin with one on the robot.
    while (nearest_m(cars, robot.centre) < 15.0) {
        drive(0.1, {});
    }
    off_robot_m = kInfinity;
    drive(120.0, std::vector<Circle>{robot});
    CHECK(off_robot_m > 0.1);
    CHECK(off_robot_m < 2.0);  // they did come by
    drive(10.0, std::vector<Circle>{robot});
    for (std::size_t i = 0; i < way_m.size(); ++i) {
        CHECK((i % 2 == 0 ? way_m[i] < 0.1 : way_m[i] > 5.0));  // one lane stands, the other drives
    }
    drive(10.0, {});
    CHECK(*std::max_element(way_m.begin(), way_m.end()) > 20.0);
}

TEST_CASE("cars keep off what stands beside the roads of the campus and of the car park") {
    for (const char* name : {"campus", "parking"}) {
        const Scene scene = make_scene(name);
        Cars cars(scene.route, 8, {scene.P_world_start.x_m, scene.P_world_start.y_m}, 1);
        double nearest_wall_m = kInfinity;
        for (int step = 0; step < 4000; ++step) {
            cars.advance(0.1, {});
            for (const Box& box : cars.boxes()) {
                nearest_wall_m = std::min(nearest_wall_m, clearance_m(scene.world, box));
            }
        }
        CAPTURE(name, nearest_wall_m);
        CHECK(nearest_wall_m > 0.2);
    }
}

TEST_CASE("a robot among cars is neither run into nor stopped, and sees them") {
    const auto nearest_and_way = [](std::size_t cars) {
        SimulationParams params = test::ideal();
        params.robot = car();
        params.robot.speed_mps = 4.0;
        params.lidar = lidar_model("scan270");
        params.lidar.noise_m = 0.0;
        params.lidar.dropout = 0.0;
        params.lidar.scan_rate_hz = 10.0;
        params.duration_s = 80.0;
        params.cars = cars;
        test::Recorder recorder;
        const SimulationResult result = test::run(make_scene("parking"), params, recorder);
        int nearest_mm = 1'000'000;
        for (const auto& scan : recorder.scans()) {
            nearest_mm =
                std::min(nearest_mm, *std::min_element(scan.record.range_mm.begin(), scan.record.range_mm.end()));
        }
        return std::pair(nearest_mm, result.driven_m);
    };
    const auto [alone_mm, alone_m] = nearest_and_way(0);
    const auto [among_mm, among_m] = nearest_and_way(16);
    CHECK(alone_mm > 3000);
    CHECK(among_mm < 2500);
    CHECK(among_mm > 1000);  // the robot's radius
    CHECK(among_m > 0.9 * alone_m);
}

TEST_CASE("more cars than a road has room for are refused") {
    CHECK_THROWS_AS(Cars(road(), 200, {}, 1), InputError);
    CHECK(Cars(road(), 0, {}, 1).boxes().empty());
    SimulationParams params = test::ideal();
    params.cars = 1;
    test::Recorder recorder;
    CHECK_THROWS_AS(test::run(test::room(10.0, 5.0), params, recorder), InputError);  // no road
}

TEST_CASE("lidars meet a car's body, and one of many rings its cabin and what is above it, too") {
    const SinCos askew = sin_cos(radians(90.0));
    const std::vector<Box> car{
        {.centre = {6.0, 5.0}, .heading = askew, .half_length_m = 2.25, .half_width_m = 0.9, .height_m = 0.9},
        {.centre = {6.0, 5.0}, .heading = askew, .half_length_m = 1.0, .half_width_m = 0.75, .height_m = 1.5}};
    const std::vector<Segment> walls = test::box(0.0, 0.0, 20.0, 10.0);
    LidarModel model = test::ideal().lidar;
    model.range_max_m = 30.0;
    Lidar planar(model, 1);
    const Pose2 here{.x_m = 2.0, .y_m = 5.0, .theta_rad = 0.0};
    CHECK(planar.read_mm(World(walls), {.cars = car}, here, 340) == 3100);
    CHECK(planar.read_mm(World(walls), {}, here, 340) == 18000);

    const World3d world(World(walls), {}, {}, Terrain());
    const auto look = [&](double elevation_deg) {
        const SinCos up = sin_cos(radians(elevation_deg));
        const double ground_m = world.terrain().height_m({2.0, 5.0});
        return world.cast({.x = 2.0, .y = 5.0, .z = ground_m + 0.5}, {.x = up.cos, .y = 0.0, .z = up.sin},
                          {.cars = car}, 100.0);
    };
    CHECK(look(0.0).surface == Surface::kCar);
    CHECK(look(0.0).range_m == Approx(3.1));
    CHECK(look(12.0).surface == Surface::kCar);
    CHECK(look(12.0).range_m * sin_cos(radians(12.0)).cos == Approx(3.25));
    CHECK(look(25.0).surface == Surface::kNothing);
    CHECK(look(-15.0).surface == Surface::kGround);
}

}  // namespace crspf::sim
