#include "tools/view/path_keeper.hpp"

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <limits>

using crspf::view::PathKeeper;

TEST_CASE("path: a pose each 10 cm, wherever the robot stands still") {
    PathKeeper path;
    for (int i = 0; i < 100; ++i) {
        path.add({.x_m = 0.01 * i, .y_m = 0.0, .theta_rad = 0.1 * i});
    }
    CHECK(path.poses().size() == 10);
    CHECK_FALSE(path.add({.x_m = std::numeric_limits<double>::quiet_NaN(), .y_m = 0.0, .theta_rad = 0.0}));
    path.clear();
    CHECK(path.poses().empty());
}

TEST_CASE("path: bounded and even over a way of any length") {
    PathKeeper path;
    constexpr int kPoses = 40'000;
    for (int i = 0; i < kPoses; ++i) {
        path.add({.x_m = 0.11 * i, .y_m = 0.0, .theta_rad = 0.0});
        REQUIRE(path.poses().size() <= PathKeeper::kPosesMax);
    }
    CHECK(path.poses().size() > PathKeeper::kPosesMax / 3);
    CHECK(path.poses().front().x_m == 0.0);
    double longest_m = 0.0;
    for (std::size_t i = 1; i < path.poses().size(); ++i) {
        longest_m = std::max(longest_m, path.poses()[i].x_m - path.poses()[i - 1].x_m);
    }
    CHECK(longest_m < 2.0);
    CHECK(0.11 * kPoses - path.poses().back().x_m < 2.0);
}
