#include <catch2/catch.hpp>
#include <cmath>

#include "core/base/trig.hpp"
#include "platform/files/input_error.hpp"
#include "tests/unit/sim/recorder.hpp"
#include "tools/sim/lidar_model.hpp"

namespace crspf::sim {

namespace {

LidarModel without_noise(const char* name) {
    LidarModel model = lidar_model(name);
    model.noise_m = 0.0;
    model.noise_fraction = 0.0;
    model.dropout = 0.0;
    return model;
}

double deviation_mm(const char* name, double range_m) {
    LidarModel model = lidar_model(name);
    model.dropout = 0.0;
    Lidar lidar(model, 5);
    const World world(test::box(-1.0, -1.0, range_m, 1.0));
    const auto forward = static_cast<std::uint32_t>(std::lround(-model.angle_min_rad / model.increment_rad));
    double squares = 0.0;
    constexpr int kCount = 4000;
    for (int i = 0; i < kCount; ++i) {
        const double error = lidar.read_mm(world, {}, {}, forward) - range_m * 1000.0;
        squares += error * error;
    }
    return std::sqrt(squares / kCount);
}

}  // namespace

TEST_CASE("each model looks forward, left and right where its data sheet says") {
    const World world(test::box(-1.0, -2.0, 3.0, 4.0));
    for (const char* name : {"urg", "lms", "scan270"}) {
        CAPTURE(name);
        Lidar lidar(without_noise(name), 1);
        const LidarModel& model = lidar.model();
        const auto beam_at = [&](double deg) {
            return static_cast<std::uint32_t>(std::lround((radians(deg) - model.angle_min_rad) / model.increment_rad));
        };
        CHECK(lidar.read_mm(world, {}, {}, beam_at(0.0)) == 3000);
        CHECK(lidar.read_mm(world, {}, {}, beam_at(90.0)) == 4000);
        CHECK(lidar.read_mm(world, {}, {}, beam_at(-90.0)) == 2000);
        CHECK(lidar.read_mm(world, {}, {.x_m = 0.5, .y_m = 0.0, .theta_rad = kPi / 2.0}, beam_at(-90.0)) == 2500);
    }
}

TEST_CASE("a beam without echo reads what the model reads") {
    const World world(test::box(-200.0, -200.0, 200.0, 200.0));
    CHECK(Lidar(without_noise("urg"), 1).read_mm(world, {}, {}, 300) == 0);
    CHECK(Lidar(without_noise("lms"), 1).read_mm(world, {}, {}, 90) == 81830);
    CHECK(Lidar(without_noise("scan270"), 1).read_mm(world, {}, {}, 540) == 65533);
}

TEST_CASE("what is too near, or dropped, reads 0") {
    const World world(test::box(-5.0, -5.0, 0.015, 5.0));
    CHECK(Lidar(without_noise("urg"), 1).read_mm(world, {}, {}, 340) == 0);
    LidarModel deaf = without_noise("urg");
    deaf.dropout = 1.0;
    CHECK(Lidar(deaf, 1).read_mm(World(test::box(-2.0, -2.0, 2.0, 2.0)), {}, {}, 340) == 0);
}

TEST_CASE("noise grows with the range as the data sheet says") {
    CHECK(deviation_mm("urg", 0.5) == Approx(10.0).margin(0.6));
    CHECK(deviation_mm("urg", 4.0) == Approx(40.0).margin(2.0));
    CHECK(deviation_mm("lms", 20.0) == Approx(10.0).margin(0.6));
    CHECK(deviation_mm("scan270", 20.0) == Approx(12.0).margin(0.6));
}

TEST_CASE("people block rays, and only those that meet them") {
    const World world(test::box(-5.0, -5.0, 5.0, 5.0));
    Lidar lidar(without_noise("urg"), 1);
    const std::vector<Circle> leg{{.centre = {2.0, 0.0}, .radius_m = 0.1}};
    CHECK(lidar.read_mm(world, {.legs = leg}, {}, 340) == 1900);
    CHECK(lidar.read_mm(world, {.legs = leg}, {}, 340 + 40) == lidar.read_mm(world, {}, {}, 340 + 40));
    const std::vector<Circle> behind_wall{{.centre = {5.5, 0.0}, .radius_m = 0.1}};
    CHECK(lidar.read_mm(world, {.legs = behind_wall}, {}, 340) == 5000);
}

TEST_CASE("a door 5 cm deep shows in the ranges") {
    const Scene scene = make_scene("corridor");
    Lidar lidar(without_noise("lms"), 1);
    const Pose2 beside_door{.x_m = 1.45, .y_m = 1.1, .theta_rad = 0.0};
    const Pose2 beside_wall{.x_m = 3.0, .y_m = 1.1, .theta_rad = 0.0};
    CHECK(lidar.read_mm(scene.world, {}, beside_door, 0) == 1150);
    CHECK(lidar.read_mm(scene.world, {}, beside_wall, 0) == 1100);
}

TEST_CASE("each beam is measured from where the robot is at its own time") {
    // Five beams, 20 ms apart, from a robot that drives towards the wall at x = 30 m.
    test::Recorder recorder;
    SimulationParams params = test::ideal();
    params.lidar.beams = 5;
    params.lidar.angle_min_rad = -0.2;
    params.lidar.increment_rad = 0.1;
    params.lidar.revolution_s = 0.02 * 2.0 * kPi / 0.1;
    params.lidar.range_max_m = 100.0;
    params.P_base_lidar = {.x_m = 0.1, .y_m = 0.0, .theta_rad = 0.0};
    params.path = {{1.0, 50.0}, {20.0, 50.0}};
    params.duration_s = 5.0;
    const SimulationResult result = test::run(test::room(30.0, 100.0), params, recorder);
    REQUIRE(recorder.scans().size() > 30);
    const std::size_t cruising = 25;
    const ScanRecord& scan = recorder.scans()[cruising].record;
    const double x0_m = result.truth[cruising].P_map_base.x_m;
    CHECK(result.truth[cruising + 1].P_map_base.x_m - x0_m == Approx(0.05));
    for (std::uint32_t i = 0; i < 5; ++i) {
        const double lidar_x_m = x0_m + 0.5 * 0.02 * i + 0.1;
        CHECK(scan.range_mm[i] == Approx(1000.0 * (30.0 - lidar_x_m) / std::cos(-0.2 + 0.1 * i)).margin(0.6));
    }
}

TEST_CASE("there is no lidar of another name") {
    CHECK_THROWS_AS(lidar_model("hdl64"), InputError);
}

}  // namespace crspf::sim
