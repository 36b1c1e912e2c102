#include <catch2/catch.hpp>
#include <cmath>
#include <cstdint>

#include "core/base/trig.hpp"
#include "tests/unit/sim/recorder.hpp"
#include "tools/sim/robot.hpp"

namespace crspf::sim {

namespace {

struct Driven {
    Pose2 truth;
    Pose2 odometry;
};

Driven drive(const RobotParams& params, const Command& command, double seconds) {
    Robot robot(params, {}, 1);
    WheelOdometer odometer(params);
    constexpr double kStep_s = 0.02;
    const std::int64_t steps = std::llround(seconds / kStep_s);
    for (std::int64_t i = 0; i < steps; ++i) {
        odometer.update(robot.advance(command, kStep_s).counts_at(kStep_s), kStep_s);
    }
    return {.truth = robot.pose(), .odometry = odometer.pose()};
}

RobotParams ideal_robot() {
    return test::ideal().robot;
}

}  // namespace

TEST_CASE("an arc is a piece of its circle") {
    const Pose2 quarter = arc(kPi / 2.0 * 3.0, kPi / 2.0);
    CHECK(quarter.x_m == Approx(3.0));
    CHECK(quarter.y_m == Approx(3.0));
    CHECK(quarter.theta_rad == Approx(kPi / 2.0));
    CHECK(arc(2.0, 0.0) == Pose2{.x_m = 2.0, .y_m = 0.0, .theta_rad = 0.0});
    // Where the series takes over from the quotient nothing jumps.
    CHECK(arc(1.0, 1.999e-4).y_m == Approx(arc(1.0, 2.001e-4).y_m).epsilon(2e-3));
}

TEST_CASE("odometry of an ideal robot tells the truth") {
    const Driven driven = drive(ideal_robot(), {.speed_mps = 0.5, .turn_rate_radps = 0.3}, 20.0);
    CHECK(driven.odometry.x_m == Approx(driven.truth.x_m).margin(1e-4));
    CHECK(driven.odometry.y_m == Approx(driven.truth.y_m).margin(1e-4));
    CHECK(wrap_angle(driven.odometry.theta_rad - driven.truth.theta_rad) == Approx(0.0).margin(1e-4));
}

TEST_CASE("wheels that count too much lengthen the way") {
    RobotParams params = ideal_robot();
    params.odom_scale_error = 0.02;
    const Driven driven = drive(params, {.speed_mps = 0.5, .turn_rate_radps = 0.0}, 20.0);
    CHECK(driven.odometry.x_m / driven.truth.x_m == Approx(1.02).epsilon(1e-4));
    CHECK(driven.odometry.theta_rad == Approx(0.0).margin(1e-4));
}

TEST_CASE("a right wheel that counts more than the left bends the way to the left") {
    RobotParams params = ideal_robot();
    params.odom_bias = 0.01;
    const Driven driven = drive(params, {.speed_mps = 0.5, .turn_rate_radps = 0.0}, 20.0);
    CHECK(driven.odometry.theta_rad == Approx(0.01 * driven.truth.x_m / params.wheel_span_m).epsilon(1e-3));
}

TEST_CASE("slip makes odometry drift, and coarse encoders do not") {
    RobotParams coarse = ideal_robot();
    coarse.counts_per_turn = 200.0;
    const Driven exact = drive(coarse, {.speed_mps = 0.5, .turn_rate_radps = 0.1}, 60.0);
    CHECK(std::abs(wrap_angle(exact.odometry.theta_rad - exact.truth.theta_rad)) <
          2.0 * coarse.metres_per_count() / coarse.wheel_span_m);
    RobotParams slipping = ideal_robot();
    slipping.slip = 0.01;
    const Driven drifted = drive(slipping, {.speed_mps = 0.5, .turn_rate_radps = 0.1}, 60.0);
    // Standard deviation sqrt(2 * 30 m) * 0.01 / 0.33 m = 0.23 rad.
    const double drift = std::abs(wrap_angle(drifted.odometry.theta_rad - drifted.truth.theta_rad));
    CHECK(drift > 0.005);
    CHECK(drift < 1.0);
}

TEST_CASE("the robot keeps its limits of speed-up and turn") {
    RobotParams params = ideal_robot();
    Robot robot(params, {}, 1);
    const Motion first = robot.advance({.speed_mps = 5.0, .turn_rate_radps = 100.0}, 0.1);
    CHECK(first.speed_mps == Approx(params.acceleration_mps2 * 0.1));
    CHECK(first.turn_rate_radps == Approx(params.turn_acceleration_radps2 * 0.1));
    for (int i = 0; i < 100; ++i) {
        CHECK(robot.advance({.speed_mps = 5.0, .turn_rate_radps = 100.0}, 0.1).turn_rate_radps <=
              params.turn_rate_radps);
    }
}

TEST_CASE("an Ackermann robot cannot turn on the spot, nor tighter than its steering allows") {
    RobotParams params = ideal_robot();
    params.drive = Drive::kAckermann;
    Robot robot(params, {}, 1);
    for (int i = 0; i < 50; ++i) {
        CHECK(robot.advance({.speed_mps = 0.0, .turn_rate_radps = 1.0}, 0.02).turn_rate_radps == 0.0);
    }
    Motion motion;
    for (int i = 0; i < 200; ++i) {
        motion = robot.advance({.speed_mps = 0.3, .turn_rate_radps = 3.0}, 0.02);
    }
    CHECK(motion.speed_mps / motion.turn_rate_radps >= params.turning_radius_m - 1e-9);
}

}  // namespace crspf::sim
