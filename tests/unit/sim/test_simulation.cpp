#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <cstddef>
#include <cstdlib>
#include <filesystem>
#include <span>
#include <string>

#include "core/base/trig.hpp"
#include "platform/files/input_error.hpp"
#include "platform/files/sha256.hpp"
#include "tests/unit/sim/recorder.hpp"
#include "tools/sim/scene.hpp"
#include "tools/sim/simulation.hpp"

namespace crspf::sim {

namespace {

std::string log_of(const Scene& scene, const SimulationParams& params) {
    std::string log;
    const std::unique_ptr<LogWriter> writer = carmen_writer(params.lidar, params.P_base_lidar);
    static_cast<void>(simulate(
        scene, params, *writer, [&](std::string_view text) { log += text; }, [](double) {}));
    return log;
}

double least_clearance_m(const Scene& scene, const SimulationResult& result) {
    double least_m = 1.0;
    for (const TimedPose& pose : result.truth) {
        least_m = std::min(least_m, scene.world.clearance({pose.P_map_base.x_m, pose.P_map_base.y_m}, 1.0));
    }
    return least_m;
}

SimulationParams usual() {
    SimulationParams params;
    params.lidar = lidar_model("urg");
    params.P_base_lidar = {.x_m = 0.145, .y_m = 0.0, .theta_rad = 0.0};
    return params;
}

}  // namespace

TEST_CASE("the same seed gives the same bytes, another seed others") {
    const Scene scene = make_scene("office");
    SimulationParams params = usual();
    params.people = 3;
    params.duration_s = 20.0;
    const std::string log = log_of(scene, params);
    CHECK(log.size() > 100000);
    CHECK(log == log_of(make_scene("office"), params));
    params.seed = 2;
    CHECK(log != log_of(scene, params));
}

// The compilers once disagreed about the order of arguments, and so about which random number was whose.
TEST_CASE("worlds are the same whatever compiled them") {
    const auto digest = [](const char* name) {
        Sha256 sha;
        const Scene scene = make_scene(name);
        sha.update(std::as_bytes(std::span(scene.world.walls())));
        for (const Crown& crown : scene.crowns) {
            sha.update(std::as_bytes(std::span(&crown, 1)));
        }
        return sha.hex();
    };
    CHECK(digest("lobby") == "fb05d29723491fd40c161009cbe6266a9264331bbdd94dcd40c4a9c78238ab5a");
    CHECK(digest("arena") == "eafb4ccebf42f787b6f1338b44785a8f8a5de5c6204e997b3312392ecfb6c9f4");
    CHECK(digest("campus") == "a52a615ea960637af7abf0362f1026af3c87b447b161f6e1fd7746e51b7452cf");
    CHECK(digest("parking") == "dad34e1c73a58fcfa94181e6185656f100f6e8f778e0107e6619619842c8544d");
}

TEST_CASE("the robot visits all places of every built-in world and touches no wall") {
    for (const char* name : kSceneNames) {
        const Scene scene = make_scene(name);
        for (const Drive drive : {Drive::kDifferential, Drive::kAckermann}) {
            CAPTURE(name, drive == Drive::kAckermann);
            test::Recorder recorder;
            SimulationParams params = usual();
            params.robot.drive = drive;
            const SimulationResult result = test::run(scene, params, recorder);
            CHECK(least_clearance_m(scene, result) > 0.95 * params.robot.radius_m);
            CHECK(result.given_up == 0);
            CHECK(result.driven_m > (std::string(name) == "arena" ? 20.0 : 100.0));
            const Pose2& end = result.truth.back().P_map_base;
            CHECK(distance({end.x_m, end.y_m}, {scene.P_world_start.x_m, scene.P_world_start.y_m}) < 0.5);
        }
    }
}

TEST_CASE("among people the robot still touches no wall, and gets on") {
    const Scene scene = make_scene("corridor");
    test::Recorder recorder;
    SimulationParams params = usual();
    params.people = 6;
    const SimulationResult result = test::run(scene, params, recorder);
    CHECK(least_clearance_m(scene, result) > 0.95 * params.robot.radius_m);
    CHECK(result.driven_m > 100.0);
}

TEST_CASE("odometry of an ideal robot follows the truth all along") {
    const Scene scene = make_scene("meeting");
    test::Recorder recorder;
    const SimulationResult result = test::run(scene, test::ideal(), recorder);
    const Pose2 P_start_world = inverse(scene.P_world_start);
    std::size_t compared = 0;
    for (std::size_t i = 0; i < result.truth.size(); ++i) {
        const std::int64_t stamp_us = recorder.scans()[i].record.stamp_us;
        const auto odometry = std::find_if(recorder.odometry().begin(), recorder.odometry().end(),
                                           [&](const OdometryRecord& o) { return o.stamp_us == stamp_us; });
        if (i % 100 != 0 || odometry == recorder.odometry().end()) {
            continue;
        }
        const Pose2 truth = P_start_world * result.truth[i].P_map_base;
        REQUIRE(odometry->P_odom_base.x_m == Approx(truth.x_m).margin(0.002));
        REQUIRE(odometry->P_odom_base.y_m == Approx(truth.y_m).margin(0.002));
        REQUIRE(wrap_angle(odometry->P_odom_base.theta_rad - truth.theta_rad) == Approx(0.0).margin(0.001));
        ++compared;
    }
    CHECK(compared > 20);
}

TEST_CASE("a scan comes when its sweep is over, with the stamp of its first beam") {
    for (const char* lidar : {"urg", "lms", "scan270"}) {
        CAPTURE(lidar);
        test::Recorder recorder;
        SimulationParams params = usual();
        params.lidar = lidar_model(lidar);
        params.duration_s = 10.0;
        const SimulationResult result = test::run(make_scene("hall"), params, recorder);
        const double period_us = 1e6 / params.lidar.scan_rate_hz;
        const double sweep_us = 1e6 * params.lidar.time_per_beam_s() * (params.lidar.beams - 1);
        REQUIRE(result.truth.size() == recorder.scans().size());
        CHECK(static_cast<double>(recorder.scans().size()) == Approx(10.0 * params.lidar.scan_rate_hz).margin(1.0));
        for (std::size_t i = 0; i < recorder.scans().size(); ++i) {
            const test::Recorder::Scan& scan = recorder.scans()[i];
            const auto stamp_us = static_cast<double>(scan.record.stamp_us);
            const auto newest_us = static_cast<double>(scan.newest_odometry_us);
            REQUIRE(stamp_us == Approx(static_cast<double>(i) * period_us).margin(1.0));
            REQUIRE(result.truth[i].stamp_s * 1e6 == Approx(stamp_us).margin(0.01));
            REQUIRE(newest_us + 1.0 >= stamp_us + sweep_us);
            REQUIRE(newest_us < stamp_us + sweep_us + 20001.0);
        }
    }
}

TEST_CASE("limits of time and way end the drive, which repeats its tour until then") {
    test::Recorder recorder;
    SimulationParams params = usual();
    params.places = 2;
    params.duration_s = 200.0;
    const Scene scene = test::room(5.0, 5.0);
    CHECK(test::run(scene, params, recorder).simulated_s == Approx(200.0).margin(0.03));
    params.duration_s.reset();
    params.distance_m = 30.0;
    CHECK(test::run(scene, params, recorder).driven_m == Approx(30.0).margin(0.02));
}

TEST_CASE("a given path is followed") {
    test::Recorder recorder;
    SimulationParams params = test::ideal();
    params.path = {{1.0, 1.0}, {4.0, 1.0}, {4.0, 4.0}};
    const SimulationResult result = test::run(test::room(5.0, 5.0), params, recorder);
    const Pose2& begin = result.truth.front().P_map_base;
    const Pose2& end = result.truth.back().P_map_base;
    CHECK(begin.x_m == Approx(1.0).margin(0.01));
    CHECK(begin.theta_rad == Approx(0.0).margin(0.01));
    CHECK(distance({end.x_m, end.y_m}, {4.0, 4.0}) < 0.35);
    for (const TimedPose& pose : result.truth) {
        const Point p{pose.P_map_base.x_m, pose.P_map_base.y_m};
        const double off_m = std::min(std::abs(p.y_m - 1.0), std::abs(p.x_m - 4.0));
        REQUIRE(off_m < 0.3);
    }
}

TEST_CASE("what does not fit is refused with a reason") {
    test::Recorder recorder;
    Scene scene = test::room(5.0, 5.0);
    SimulationParams params = usual();
    params.path = {{1.0, 1.0}, {9.0, 1.0}};
    CHECK_THROWS_WITH(test::run(scene, params, recorder), Catch::Contains("--path") && Catch::Contains("wall"));
    params.path.clear();
    scene.P_world_start.x_m = 0.1;
    CHECK_THROWS_WITH(test::run(scene, params, recorder), Catch::Contains("--start"));
    scene.P_world_start.x_m = 1e9;
    CHECK_THROWS_WITH(test::run(scene, params, recorder), Catch::Contains("--start"));
    CHECK_THROWS_AS(make_scene("ofice"), InputError);
    CHECK_THROWS_AS(make_scene("absent.yaml"), InputError);
}

TEST_CASE("the robot drives through the 1r5 map and stays in its free cells") {
    const char* const folder = std::getenv("CRSPF_DATA");
    const std::filesystem::path file =
        std::filesystem::path(folder != nullptr ? folder : CRSPF_DATA_DEFAULT) / "maps/1r5.yaml";
    if (!std::filesystem::exists(file)) {
        WARN("skipped: " << file.string() << " is absent; set CRSPF_DATA to its folder");
        return;
    }
    const Scene scene = make_scene(file.string());
    CHECK(scene.truth.width == 239);
    CHECK(scene.truth.height == 249);
    test::Recorder recorder;
    const SimulationParams params = usual();
    const SimulationResult result = test::run(scene, params, recorder);
    CHECK(result.given_up == 0);
    CHECK(least_clearance_m(scene, result) > 0.95 * params.robot.radius_m);
    for (const TimedPose& pose : result.truth) {
        const Pose2 p = inverse(scene.truth.P_map_origin) * pose.P_map_base;
        REQUIRE(scene.truth.at(static_cast<int>(p.x_m / scene.truth.resolution_m),
                               static_cast<int>(p.y_m / scene.truth.resolution_m)) == GridCell::kFree);
    }
}

}  // namespace crspf::sim
