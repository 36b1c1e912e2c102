#include <catch2/catch.hpp>
#include <filesystem>

#include "config/config.hpp"

namespace crspf {
namespace {

const std::filesystem::path kExamples = std::filesystem::path(CRSPF_SOURCE_DIR) / "config" / "examples";

TEST_CASE("every example loads") {
    int loaded = 0;
    for (const auto& entry : std::filesystem::directory_iterator(kExamples)) {
        INFO(entry.path());
        CHECK_NOTHROW(load_config(entry.path()));
        ++loaded;
    }
    CHECK(loaded >= 4);
}

TEST_CASE("the URG-04LX example describes that robot") {
    const Config config = load_config(kExamples / "urg04lx.toml");
    CHECK(config.slam.lidar.P_base_lidar == Pose2{.x_m = 0.145, .y_m = 0.0, .theta_rad = 0.0});
    CHECK(config.slam.lidar.range_max_m == 5.6);
    CHECK(config.wheels.counts_per_turn == 2000.0);
    CHECK(config.wheels.wheel_radius_m == 0.077);
    CHECK(config.slam.odometry.wheel_span_m == 0.33);
}

TEST_CASE("the examples describe sensors and robots only: all run with the same algorithm") {
    const Config defaults;
    for (const auto& entry : std::filesystem::directory_iterator(kExamples)) {
        INFO(entry.path());
        Config config = load_config(entry.path());
        config.slam.lidar = defaults.slam.lidar;
        config.slam.obstacles = defaults.slam.obstacles;
        config.slam.odometry.wheel_span_m = defaults.slam.odometry.wheel_span_m;
        config.slam.odometry.wheel_base_m = defaults.slam.odometry.wheel_base_m;
        config.slam.map.resolution_m = defaults.slam.map.resolution_m;
        config.wheels = defaults.wheels;
        config.sources.clear();
        config.stereo = defaults.stereo;
        CHECK(print_config(config) == print_config(defaults));
    }
}

}  // namespace
}  // namespace crspf
