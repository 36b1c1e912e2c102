#include <catch2/catch.hpp>
#include <cmath>

#include "core/base/pose.hpp"
#include "tests/unit/core/synthetic.hpp"

using namespace crspf;
using namespace crspf::test;

namespace {

Pose2 random_pose(Rng& rng) {
    return {.x_m = uniform(rng, -50.0, 50.0), .y_m = uniform(rng, -50.0, 50.0), .theta_rad = uniform(rng, -kPi, kPi)};
}

bool near(const Pose2& a, const Pose2& b) {
    constexpr double kTolerance = 1e-10;
    return std::abs(a.x_m - b.x_m) < kTolerance && std::abs(a.y_m - b.y_m) < kTolerance &&
           turn_between(a.theta_rad, b.theta_rad) < kTolerance;
}

}  // namespace

TEST_CASE("a pose seen from another is turned first, then moved") {
    const Pose2 a{.x_m = 1.0, .y_m = 2.0, .theta_rad = kPi / 2.0};
    const Pose2 b{.x_m = 3.0, .y_m = 0.5, .theta_rad = 0.25};
    CHECK(near(a * b, {.x_m = 0.5, .y_m = 5.0, .theta_rad = kPi / 2.0 + 0.25}));
    CHECK_FALSE(near(a * b, b * a));
}

TEST_CASE("poses form a group, with headings from -pi to below pi") {
    Rng rng(3);
    for (int i = 0; i < 2000; ++i) {
        const Pose2 a = random_pose(rng);
        const Pose2 b = random_pose(rng);
        const Pose2 c = random_pose(rng);
        REQUIRE(near(a * inverse(a), {}));
        REQUIRE(near(inverse(a) * a, {}));
        REQUIRE(near((a * b) * c, a * (b * c)));
        REQUIRE(near(inverse(a * b), inverse(b) * inverse(a)));
        for (const double theta_rad : {(a * b).theta_rad, inverse(a).theta_rad, interpolate(a, b, 0.7).theta_rad}) {
            REQUIRE(theta_rad >= -kPi);
            REQUIRE(theta_rad < kPi);
        }
    }
    CHECK(inverse({.theta_rad = -kPi}).theta_rad == -kPi);
}

TEST_CASE("interpolation is exact at its ends and takes the short turn") {
    const Pose2 a{.x_m = 1.0, .y_m = -2.0, .theta_rad = 3.0};
    const Pose2 b{.x_m = 3.0, .y_m = 6.0, .theta_rad = -3.0};
    CHECK(near(interpolate(a, b, 0.0), a));
    CHECK(near(interpolate(a, b, 1.0), b));
    // From 3.0 to -3.0 is 0.283 rad across pi, not 6 rad across 0.
    CHECK(near(interpolate(a, b, 0.25), {.x_m = 1.5, .y_m = 0.0, .theta_rad = 3.0 + 0.25 * (2.0 * kPi - 6.0)}));
    CHECK(near(interpolate(b, a, 0.75), interpolate(a, b, 0.25)));
}
