#include <catch2/catch.hpp>
#include <cmath>
#include <limits>
#include <utility>

#include "core/odometry/motion_models.hpp"
#include "core/odometry/odometry.hpp"
#include "tests/unit/core/synthetic.hpp"

using namespace crspf;
using namespace crspf::test;

namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kLargest = std::numeric_limits<double>::max();

constexpr Stamp at_ms(int ms) {
    return {ms * 1'000'000LL};
}
MotionSample moved(int ms, const Pose2& step) {
    return {.stamp = at_ms(ms), .P_previous_base = step};
}
bool near(const Pose2& a, const Pose2& b, double tolerance = 1e-9) {
    return std::hypot(a.x_m - b.x_m, a.y_m - b.y_m) < tolerance && turn_between(a.theta_rad, b.theta_rad) < tolerance;
}
bool finite(const Pose2& p) {
    return std::isfinite(p.x_m) && std::isfinite(p.y_m) && std::isfinite(p.theta_rad);
}

/// Ten steps of 0.1 m, 100 ms apart, along x; the first pose, x = 0, is at 1000 ms.
Odometry straight_drive() {
    Odometry odometry({});
    odometry.add(moved(1000, {}));
    for (int i = 1; i <= 10; ++i) {
        odometry.add(moved(1000 + 100 * i, {.x_m = 0.1}));
    }
    return odometry;
}

}  // namespace

TEST_CASE("before the first sample the robot stands where it was placed") {
    Odometry odometry({});
    CHECK(odometry.pose() == Pose2{});
    const Pose2 place{.x_m = 3.0, .y_m = -1.0, .theta_rad = 0.5};
    odometry.set_pose(place);
    CHECK(near(odometry.pose(), place));
    CHECK(near(odometry.pose_at(at_ms(123)), place));
    odometry.add(moved(1000, {.x_m = 1.0}));
    CHECK(near(odometry.pose(), place * Pose2{.x_m = 1.0}));
}

TEST_CASE("a pose is found at any stamp of the history") {
    const Odometry odometry = straight_drive();
    CHECK(odometry.pose_at(at_ms(1000)).x_m == Approx(0.0).margin(1e-12));
    CHECK(odometry.pose_at(at_ms(1500)).x_m == Approx(0.5));
    CHECK(odometry.pose_at(at_ms(1550)).x_m == Approx(0.55));
    CHECK(odometry.pose_at(at_ms(1999)).x_m == Approx(0.999));
    CHECK(odometry.pose_at(at_ms(2000)).x_m == Approx(1.0));
    CHECK(odometry.counters().out_of_history == 0);

    SECTION("before it the oldest pose holds, and that is counted") {
        CHECK(odometry.pose_at(at_ms(500)).x_m == 0.0);
        CHECK(odometry.counters().out_of_history == 1);
    }
    SECTION("after it the last speed is held for 0.2 s, then the robot stands") {
        CHECK(odometry.pose_at(at_ms(2050)).x_m == Approx(1.05));
        CHECK(odometry.pose_at(at_ms(2200)).x_m == Approx(1.2));
        CHECK(odometry.pose_at(at_ms(2201)).x_m == Approx(1.2));
        CHECK(odometry.pose_at(at_ms(3'600'000)).x_m == Approx(1.2));
    }
}

TEST_CASE("headings are interpolated across pi") {
    Odometry odometry({});
    odometry.set_pose({.theta_rad = kPi - 0.05});
    odometry.add(moved(0, {}));
    odometry.add(moved(100, {.theta_rad = 0.1}));
    CHECK(turn_between(odometry.pose_at(at_ms(50)).theta_rad, kPi) < 1e-9);
    CHECK(turn_between(odometry.pose_at(at_ms(75)).theta_rad, kPi + 0.025) < 1e-9);
}

TEST_CASE("the history is a ring: its last samples are there, older ones are not") {
    Odometry odometry({});
    constexpr int kSamples = static_cast<int>(capacity::kMotionHistory) * 2 + 77;
    for (int i = 0; i < kSamples; ++i) {
        odometry.add(moved(10 * i, {.x_m = i == 0 ? 0.0 : 0.01}));
    }
    constexpr int kOldest = kSamples - static_cast<int>(capacity::kMotionHistory);
    for (int i = kOldest; i < kSamples; ++i) {
        CAPTURE(i);
        REQUIRE(odometry.pose_at(at_ms(10 * i)).x_m == Approx(0.01 * i));
        if (i + 1 < kSamples) {
            REQUIRE(odometry.pose_at(at_ms(10 * i + 5)).x_m == Approx(0.01 * i + 0.005));
        }
    }
    CHECK(odometry.counters().out_of_history == 0);
    CHECK(odometry.pose_at(at_ms(10 * kOldest - 1)).x_m == Approx(0.01 * kOldest));
    CHECK(odometry.counters().out_of_history == 1);
}

TEST_CASE("a late correction moves the present pose by P(t) P~(t)^-1") {
    Rng rng(21);
    for (int round = 0; round < 200; ++round) {
        Odometry odometry({});
        odometry.set_pose(
            {.x_m = uniform(rng, -5.0, 5.0), .y_m = uniform(rng, -5.0, 5.0), .theta_rad = uniform(rng, -3.0, 3.0)});
        for (int i = 0; i < 50; ++i) {
            odometry.add(moved(20 * i, arc(uniform(rng, -0.1, 0.2), uniform(rng, -0.3, 0.3))));
        }
        const Stamp then{whole(rng, 0, 980) * 1'000'000LL};
        const Pose2 observed = odometry.pose_at(then);
        const Pose2 found =
            observed *
            Pose2{.x_m = 0.2 * rng.symmetric(), .y_m = 0.2 * rng.symmetric(), .theta_rad = 0.1 * rng.symmetric()};
        const Pose2 expected = found * inverse(observed) * odometry.pose();
        odometry.correct(then, found);
        REQUIRE(near(odometry.pose_at(then), found));
        REQUIRE(near(odometry.pose(), expected));
        // Motion after it goes on from there.
        odometry.add(moved(1000, {.x_m = 0.5}));
        REQUIRE(near(odometry.pose(), expected * Pose2{.x_m = 0.5}));
    }
}

TEST_CASE("motion between two stamps does not depend on corrections, and its doubt grows with the path") {
    OdometryParams params;
    Odometry odometry(params);
    for (int i = 0; i <= 40; ++i) {  // 2 m ahead, then the same back
        odometry.add(moved(100 * i, {.x_m = i == 0 ? 0.0 : i <= 20 ? 0.1 : -0.1}));
    }
    const MotionPrior there_and_back = odometry.motion_between(at_ms(0), at_ms(4000));
    CHECK(near(there_and_back.P_from_to, {}));
    CHECK(there_and_back.translation_stddev_m ==
          Approx(std::hypot(params.translation_floor_m, 4.0 * params.translation_per_metre)));
    CHECK(there_and_back.rotation_stddev_rad ==
          Approx(std::hypot(params.rotation_floor_rad, 4.0 * params.rotation_per_metre)));
    const MotionPrior standing = odometry.motion_between(at_ms(1000), at_ms(1000));
    CHECK(standing.translation_stddev_m == Approx(params.translation_floor_m));
    CHECK(standing.rotation_stddev_rad == Approx(params.rotation_floor_rad));

    odometry.correct(at_ms(2000), {.x_m = 7.0, .y_m = 8.0, .theta_rad = 1.0});
    CHECK(near(odometry.motion_between(at_ms(1000), at_ms(2000)).P_from_to, {.x_m = 1.0}));
    CHECK(near(odometry.motion_between(at_ms(2000), at_ms(1000)).P_from_to, {.x_m = -1.0}));

    SECTION("turns are added up, not netted") {
        Odometry turning(params);
        turning.add(moved(0, {}));
        turning.add(moved(100, {.theta_rad = 0.5}));
        turning.add(moved(200, {.theta_rad = -0.5}));
        const MotionPrior prior = turning.motion_between(at_ms(0), at_ms(200));
        CHECK(near(prior.P_from_to, {}));
        CHECK(prior.rotation_stddev_rad == Approx(std::hypot(params.rotation_floor_rad, params.rotation_per_radian)));
    }
}

TEST_CASE("what an odometer says of its own doubt comes on top, for the time that it is of") {
    const OdometryParams params;
    Odometry odometry(params);
    for (int i = 0; i <= 30; ++i) {  // 0.1 m each; blind, by its own word, in the second second
        MotionSample sample = moved(100 * i, {.x_m = i == 0 ? 0.0 : 0.1});
        sample.blind = i > 10 && i <= 20;
        sample.translation_variance_m2 = sample.blind ? 0.04 : 0.0;
        sample.rotation_variance_rad2 = sample.blind ? 0.01 : 0.0;
        odometry.add(sample);
    }
    const auto check = [&](int from_ms, int to_ms, double way_m, double samples) {
        const MotionPrior prior = odometry.motion_between(at_ms(from_ms), at_ms(to_ms));
        INFO(from_ms << " to " << to_ms);
        CHECK(prior.translation_stddev_m ==
              Approx(std::hypot(params.translation_floor_m, way_m * params.translation_per_metre,
                                std::sqrt(0.04 * samples))));
        CHECK(prior.rotation_stddev_rad ==
              Approx(
                  std::hypot(params.rotation_floor_rad, way_m * params.rotation_per_metre, std::sqrt(0.01 * samples))));
    };
    check(0, 1000, 1.0, 0.0);
    check(1000, 2000, 1.0, 10.0);
    check(1250, 1300, 0.05, 0.5);
    check(2000, 1000, 1.0, 10.0);
    check(2000, 3000, 1.0, 0.0);
    CHECK(odometry.counters().implausible == 0);

    SECTION("at the speed that is held after the last sample it grows on as it did") {
        MotionSample blind = moved(3100, {.x_m = 0.1});
        blind.translation_variance_m2 = 0.04;
        odometry.add(blind);
        CHECK(odometry.motion_between(at_ms(3100), at_ms(3200)).translation_stddev_m ==
              Approx(std::hypot(params.translation_floor_m, 0.1 * params.translation_per_metre, 0.2)));
    }
    SECTION("a boundless one is bounded") {
        for (int i = 1; i <= 3; ++i) {
            MotionSample sample = moved(3000 + 100 * i, {.x_m = 0.1});
            sample.translation_variance_m2 = sample.rotation_variance_rad2 = kLargest;
            odometry.add(sample);
        }
        const MotionPrior prior = odometry.motion_between(at_ms(3000), at_ms(3300));
        CHECK(prior.translation_stddev_m == Approx(std::sqrt(300.0)).epsilon(1e-3));
        CHECK(prior.rotation_stddev_rad == Approx(std::sqrt(3.0) * kPi).epsilon(1e-3));
    }
    SECTION("what is no variance is refused and counted") {
        const Pose2 before = odometry.pose();
        MotionSample sample = moved(3100, {.x_m = 0.1});
        sample.translation_variance_m2 = -1e-9;
        odometry.add(sample);
        std::swap(sample.translation_variance_m2, sample.rotation_variance_rad2);
        odometry.add(sample);
        CHECK(odometry.counters().implausible == 2);
        for (const double bad : {kNan, kInfinity}) {
            sample = moved(3100, {.x_m = 0.1});
            sample.translation_variance_m2 = bad;
            odometry.add(sample);
            std::swap(sample.translation_variance_m2, sample.rotation_variance_rad2);
            odometry.add(sample);
        }
        CHECK(odometry.counters().not_finite == 4);
        CHECK(odometry.pose() == before);
    }
}

TEST_CASE("wheel samples add up by the differential model") {
    OdometryParams params;
    params.wheel_span_m = 0.4;
    Odometry odometry(params);
    Pose2 expected;
    for (int i = 0; i < 100; ++i) {
        odometry.add(DifferentialSample{.stamp = at_ms(10 * i), .left_m = 0.01, .right_m = 0.012});
        expected = expected * differential_motion(0.01, 0.012, 0.4);
    }
    CHECK(near(odometry.pose(), expected));
    CHECK(odometry.counters().samples == 100);
}

TEST_CASE("a car whose front wheels tell the speed is back where it was after a circle of theirs") {
    OdometryParams params;
    params.wheel_base_m = 2.0;
    params.front_driven = true;
    constexpr double kSteering_rad = 0.5;
    const double front_radius_m = params.wheel_base_m / sin_cos(kSteering_rad).sin;
    const double speed_mps = 2.0 * kPi * front_radius_m / 10.0;
    const auto after_circle = [&](double offset_rad) {
        params.steering_offset_rad = offset_rad;
        Odometry odometry(params);
        for (int i = 0; i <= 1000; ++i) {
            odometry.add(AckermannSample{
                .stamp = at_ms(10 * i), .speed_mps = speed_mps, .steering_rad = kSteering_rad - offset_rad});
        }
        return odometry.pose();
    };
    CHECK(near(after_circle(0.0), {}));
    CHECK(near(after_circle(0.1), {}));  // of the wheels, not of what is told of them
    params.front_driven = false;
    CHECK(std::abs(after_circle(0.0).theta_rad) > 0.5);
}

TEST_CASE("speeds are integrated by the mean of an interval's ends") {
    OdometryParams params;
    params.wheel_base_m = 2.0;
    SECTION("car") {
        Odometry odometry(params);
        odometry.add(AckermannSample{.stamp = at_ms(0), .speed_mps = 1.0, .steering_rad = 0.1});
        CHECK(odometry.pose() == Pose2{});
        odometry.add(AckermannSample{.stamp = at_ms(100), .speed_mps = 3.0, .steering_rad = 0.3});
        CHECK(near(odometry.pose(), ackermann_motion(2.0, 0.2, 2.0, 0.1)));
    }
    SECTION("IMU") {
        Odometry odometry(params);
        odometry.add(ImuSample{.stamp = at_ms(0), .yaw_rate_radps = 0.2, .speed_mps = 1.0});
        CHECK(odometry.pose() == Pose2{});
        odometry.add(ImuSample{.stamp = at_ms(100), .yaw_rate_radps = 0.4, .speed_mps = 2.0});
        CHECK(near(odometry.pose(), imu_motion(1.5, 0.3, 0.1)));
    }
}

TEST_CASE("a gap in the speeds is not integrated across, and is counted") {
    Odometry odometry({});
    odometry.add(ImuSample{.stamp = at_ms(0), .yaw_rate_radps = 0.0, .speed_mps = 1.0});
    odometry.add(ImuSample{.stamp = at_ms(1000), .yaw_rate_radps = 0.0, .speed_mps = 1.0});
    CHECK(odometry.pose().x_m == Approx(1.0));  // exactly the longest gap
    CHECK(odometry.counters().gaps == 0);
    odometry.add(ImuSample{.stamp = at_ms(2001), .yaw_rate_radps = 0.0, .speed_mps = 1.0});
    CHECK(odometry.pose().x_m == Approx(1.0));
    CHECK(odometry.counters().gaps == 1);
    CHECK(odometry.pose_at(at_ms(2100)).x_m == Approx(1.0));  // no speed is known across the gap
    odometry.add(ImuSample{.stamp = at_ms(2101), .yaw_rate_radps = 0.0, .speed_mps = 1.0});
    CHECK(odometry.pose().x_m == Approx(1.1));
}

TEST_CASE("samples whose stamp ran back are counted") {
    SECTION("an increment is kept: the motion happened") {
        Odometry odometry = straight_drive();
        odometry.add(moved(1500, {.x_m = 0.1}));
        CHECK(odometry.pose().x_m == Approx(1.1));
        CHECK(odometry.counters().ran_back == 1);
        // The history stays in order: what lay before is found as before.
        CHECK(odometry.pose_at(at_ms(1550)).x_m == Approx(0.55));
        CHECK(odometry.pose_at(at_ms(1999)).x_m == Approx(0.999));
        odometry.add(moved(2100, {.x_m = 0.1}));
        CHECK(odometry.pose().x_m == Approx(1.2));
        CHECK(odometry.pose_at(at_ms(2050)).x_m == Approx(1.15));
    }
    SECTION("a speed says nothing about time that runs back") {
        Odometry odometry({});
        odometry.add(ImuSample{.stamp = at_ms(500), .yaw_rate_radps = 0.0, .speed_mps = 1.0});
        odometry.add(ImuSample{.stamp = at_ms(400), .yaw_rate_radps = 0.0, .speed_mps = 1.0});
        CHECK(odometry.pose() == Pose2{});
        CHECK(odometry.counters().ran_back == 1);
    }
    SECTION("equal stamps are in order") {
        Odometry odometry = straight_drive();
        odometry.add(moved(2000, {.x_m = 0.1}));
        CHECK(odometry.counters().ran_back == 0);
        CHECK(odometry.pose().x_m == Approx(1.1));
        CHECK(finite(odometry.pose_at(at_ms(2050))));
    }
}

TEST_CASE("numbers that are none are refused and counted") {
    Odometry odometry = straight_drive();
    const Pose2 before = odometry.pose();
    std::uint64_t refused = 0;
    for (const double bad : {kNan, kInfinity, -kInfinity}) {
        odometry.add(DifferentialSample{.stamp = at_ms(2100), .left_m = bad, .right_m = 0.0});
        odometry.add(DifferentialSample{.stamp = at_ms(2100), .left_m = 0.0, .right_m = bad});
        odometry.add(AckermannSample{.stamp = at_ms(2100), .speed_mps = bad, .steering_rad = 0.0});
        odometry.add(AckermannSample{.stamp = at_ms(2100), .speed_mps = 0.0, .steering_rad = bad});
        odometry.add(ImuSample{.stamp = at_ms(2100), .yaw_rate_radps = bad, .speed_mps = 0.0});
        odometry.add(ImuSample{.stamp = at_ms(2100), .yaw_rate_radps = 0.0, .speed_mps = bad});
        odometry.add(moved(2100, {.x_m = bad}));
        odometry.add(moved(2100, {.y_m = bad}));
        odometry.add(moved(2100, {.theta_rad = bad}));
        refused += 9;
        CHECK(odometry.counters().not_finite == refused);
    }
    CHECK(odometry.pose() == before);
    CHECK(odometry.counters().samples == 11 + refused);
}

TEST_CASE("steps that no robot takes are refused and counted") {
    Odometry odometry = straight_drive();
    const Pose2 before = odometry.pose();
    odometry.add(moved(2100, {.x_m = 10.1}));
    odometry.add(moved(2100, {.x_m = 8.0, .y_m = -8.0}));
    odometry.add(DifferentialSample{.stamp = at_ms(2100), .left_m = -1.0, .right_m = 1.0});  // 6 rad
    odometry.add(DifferentialSample{.stamp = at_ms(2100), .left_m = 20.0, .right_m = 20.0});
    CHECK(odometry.counters().implausible == 4);
    CHECK(odometry.pose() == before);
    odometry.add(moved(2100, {.x_m = 9.9}));
    CHECK(odometry.counters().implausible == 4);
    CHECK(odometry.pose().x_m == Approx(before.x_m + 9.9));

    SECTION("even those whose sum overflows") {
        odometry.add(DifferentialSample{.stamp = at_ms(2200), .left_m = kLargest, .right_m = kLargest});
        CHECK(finite(odometry.pose()));
        CHECK(odometry.counters().implausible == 5);
        odometry.add(moved(2300, {.x_m = kLargest, .y_m = kLargest}));
        CHECK(finite(odometry.pose()));
        CHECK(odometry.counters().implausible == 6);
        for (int i = 0; i < 2; ++i) {
            odometry.add(ImuSample{.stamp = at_ms(2400 + 100 * i), .yaw_rate_radps = 0.0, .speed_mps = kLargest});
            odometry.add(AckermannSample{.stamp = at_ms(2450 + 100 * i), .speed_mps = kLargest, .steering_rad = 0.0});
        }
        CHECK(finite(odometry.pose()));
        CHECK(odometry.counters().implausible > 6);
    }
}
