#include <catch2/catch.hpp>
#include <cmath>

#include "core/odometry/motion_models.hpp"
#include "tests/unit/core/synthetic.hpp"

using namespace crspf;
using namespace crspf::test;

namespace {

/// (1) and (2) as printed: a circle of radius B (R + L) / (2 (R - L)). Not for R = L.
Pose2 circle(double left_m, double right_m, double span_m) {
    const double turn = (right_m - left_m) / span_m;
    const double radius = span_m * (right_m + left_m) / (2.0 * (right_m - left_m));
    return {.x_m = radius * std::sin(turn), .y_m = radius * (1.0 - std::cos(turn)), .theta_rad = turn};
}

double apart(const Pose2& a, const Pose2& b) {
    return std::max(std::hypot(a.x_m - b.x_m, a.y_m - b.y_m), turn_between(a.theta_rad, b.theta_rad));
}

}  // namespace

TEST_CASE("the differential drive follows (1) and (2)") {
    Rng rng(11);
    for (int i = 0; i < 20000; ++i) {
        const double span = uniform(rng, 0.1, 2.0);
        const double left = uniform(rng, -1.0, 1.0);
        const double right = uniform(rng, -1.0, 1.0);
        if (std::abs(right - left) < 1e-3) {
            continue;
        }
        CAPTURE(left, right, span);
        REQUIRE(apart(differential_motion(left, right, span), circle(left, right, span)) < 1e-11);
    }
    SECTION("equal wheels drive straight on") {
        CHECK(differential_motion(0.3, 0.3, 0.4) == Pose2{.x_m = 0.3});
        CHECK(differential_motion(-0.3, -0.3, 0.4) == Pose2{.x_m = -0.3});
    }
    SECTION("opposite wheels turn on the spot, the left way when the right wheel leads") {
        const Pose2 turned = differential_motion(-0.1, 0.1, 0.4);
        CHECK(std::hypot(turned.x_m, turned.y_m) == 0.0);
        CHECK(turned.theta_rad == Approx(0.5));
    }
    SECTION("one wheel stands: the circle is about it") {
        const Pose2 turned = differential_motion(0.0, 0.4 * kPi / 2.0, 0.4);
        CHECK(apart(turned, {.x_m = 0.2, .y_m = 0.2, .theta_rad = kPi / 2.0}) < 1e-12);
    }
}

TEST_CASE("the motion is continuous where the wheels are equal") {
    const Pose2 straight = arc(2.0, 0.0);
    CHECK(straight == Pose2{.x_m = 2.0});
    for (const double turn : {1e-300, 1e-12, 1e-9, 1e-6}) {
        for (const double sign : {-1.0, 1.0}) {
            CHECK(apart(arc(2.0, sign * turn), straight) <= 1.01 * 2.0 * turn);
        }
    }
    SECTION("and no seam shows between the series and the sine") {
        for (int i = 1; i < 4000; ++i) {
            const double turn = i * 1e-5;
            const Pose2 closed{.x_m = 2.0 * std::sin(turn) / turn,
                               .y_m = 2.0 * 2.0 * std::pow(std::sin(0.5 * turn), 2) / turn,
                               .theta_rad = turn};
            CAPTURE(turn);
            REQUIRE(apart(arc(2.0, turn), closed) < 1e-12);
        }
    }
}

TEST_CASE("an arc is the sum of its parts") {
    Rng rng(12);
    for (int i = 0; i < 5000; ++i) {
        const double distance = uniform(rng, -3.0, 3.0);
        const double turn = uniform(rng, -6.0, 6.0);
        const double u = uniform(rng, 0.0, 1.0);
        CAPTURE(distance, turn, u);
        const Pose2 parts = arc(u * distance, u * turn) * arc((1.0 - u) * distance, (1.0 - u) * turn);
        REQUIRE(apart(parts, arc(distance, turn)) < 1e-11);
        REQUIRE(apart(arc(distance, turn) * arc(-distance, -turn), {}) < 1e-11);  // driven back
    }
}

TEST_CASE("a full circle ends where it began") {
    CHECK(apart(arc(5.0, 2.0 * kPi), {}) < 1e-12);
    CHECK(apart(arc(5.0, -2.0 * kPi), {}) < 1e-12);
    CHECK(apart(arc(kPi, kPi), {.x_m = 0.0, .y_m = 2.0, .theta_rad = -kPi}) < 1e-12);
    Pose2 pose;
    for (int i = 0; i < 360; ++i) {
        pose = pose * differential_motion(0.9 * kPi / 180.0, 1.1 * kPi / 180.0, 0.2);
    }
    CHECK(apart(pose, {}) < 1e-10);
}

TEST_CASE("the car follows (3)") {
    Rng rng(13);
    for (int i = 0; i < 5000; ++i) {
        const double speed = uniform(rng, -5.0, 5.0);
        const double steering = uniform(rng, -1.3, 1.3);
        const double base = uniform(rng, 0.3, 4.0);
        const double dt = uniform(rng, 0.001, 0.2);
        const double turn = speed * std::tan(steering) / base * dt;
        const double radius = base / std::tan(steering);
        CAPTURE(speed, steering, base, dt);
        const Pose2 closed{
            .x_m = radius * std::sin(turn), .y_m = radius * (1.0 - std::cos(turn)), .theta_rad = wrap_angle(turn)};
        // The closed form loses digits as its radius grows.
        REQUIRE(apart(ackermann_motion(speed, steering, base, dt), closed) < 1e-13 * (10.0 + std::abs(radius)));
    }
    CHECK(ackermann_motion(2.0, 0.0, 2.5, 0.1) == Pose2{.x_m = 0.2});
    CHECK(ackermann_motion(1.0, 0.3, 2.5, 0.1).theta_rad > 0.0);
    CHECK(ackermann_motion(-1.0, 0.3, 2.5, 0.1).theta_rad < 0.0);

    SECTION("a steering angle that no car has is held at 80 degrees") {
        const Pose2 most = ackermann_motion(1.0, radians(80.0), 2.5, 0.1);
        CHECK(ackermann_motion(1.0, radians(90.0), 2.5, 0.1) == most);
        CHECK(ackermann_motion(1.0, 1e9, 2.5, 0.1) == most);
        CHECK(ackermann_motion(1.0, radians(-90.0), 2.5, 0.1) == ackermann_motion(1.0, radians(-80.0), 2.5, 0.1));
        CHECK_FALSE(ackermann_motion(1.0, radians(79.0), 2.5, 0.1) == most);
    }
}

TEST_CASE("speed and yaw rate are an arc") {
    CHECK(apart(imu_motion(2.0, 0.5, 0.1),
                {.x_m = 4.0 * std::sin(0.05), .y_m = 4.0 * (1.0 - std::cos(0.05)), .theta_rad = 0.05}) < 1e-12);
    CHECK(apart(imu_motion(-2.0, 0.5, 0.1),
                {.x_m = -4.0 * std::sin(0.05), .y_m = -4.0 * (1.0 - std::cos(0.05)), .theta_rad = 0.05}) < 1e-12);
    CHECK(imu_motion(2.0, 0.5, 0.0) == Pose2{});
}
