#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <memory>

#include "core/base/trig.hpp"
#include "core/odometry/inertial.hpp"
#include "tools/sim/imu_model.hpp"
#include "tools/sim/random.hpp"
#include "tools/sim/terrain.hpp"

namespace crspf::sim {
namespace {

constexpr double kLength_m = 0.35;
constexpr double kWidth_m = 0.33;

/// Between two directions. [rad]
double angle_between(const Vector3& a, const Vector3& b) {
    return std::atan2(length(cross(a, b)), dot(a, b));
}

}  // namespace

TEST_CASE("terrain: bumps are as steep as told, nowhere more") {
    const Terrain smooth;
    const Terrain rough(radians(10.0));
    CHECK(rough.height_m({0.0, 0.0}) == 0.0);
    CHECK(smooth.height_m({10.0, -5.0}) == Approx(10.0 * Terrain::kSlopeX - 5.0 * Terrain::kSlopeY));
    CHECK(rough.steepest() == Approx(smooth.steepest() + std::tan(radians(10.0))));
    Random random(3, RandomStream::kTest);
    double steepest = 0.0;
    for (int n = 0; n < 100000; ++n) {
        const Point p{random.uniform(-100.0, 100.0), random.uniform(-100.0, 100.0)};
        const SinCos heading = sin_cos(random.uniform(-kPi, kPi));
        constexpr double kStep_m = 1e-4;
        const double rise_m =
            rough.height_m({p.x_m + kStep_m * heading.cos, p.y_m + kStep_m * heading.sin}) - rough.height_m(p);
        steepest = std::max(steepest, rise_m / kStep_m);
    }
    CHECK(steepest < rough.steepest() + 1e-6);
    CHECK(steepest > 0.6 * rough.steepest());
}

TEST_CASE("terrain: a vehicle on a slope keeps its heading and leans as the slope does") {
    const Terrain smooth;
    const Frame ahead = frame_on(smooth, {.x_m = 3.0, .y_m = 4.0, .theta_rad = 0.0}, kLength_m, kWidth_m);
    CHECK(ahead.origin.z == Approx(smooth.height_m({3.0, 4.0})));
    CHECK(ahead.x.z / ahead.x.x == Approx(Terrain::kSlopeX));
    CHECK(ahead.y.z / ahead.y.y == Approx(Terrain::kSlopeY).margin(1e-5));
    const Terrain rough(radians(15.0));
    Random random(5, RandomStream::kTest);
    double most_rad = 0.0;
    for (int n = 0; n < 1000; ++n) {
        const Pose2 pose{.x_m = random.uniform(-50.0, 50.0),
                         .y_m = random.uniform(-50.0, 50.0),
                         .theta_rad = random.uniform(-kPi, kPi)};
        const Frame frame = frame_on(rough, pose, kLength_m, kWidth_m);
        REQUIRE(length(frame.x) == Approx(1.0));
        REQUIRE(length(frame.y) == Approx(1.0));
        REQUIRE(dot(frame.x, frame.y) == Approx(0.0).margin(1e-12));
        REQUIRE(length(cross(frame.x, frame.y) - frame.z) == Approx(0.0).margin(1e-12));
        REQUIRE(std::remainder(std::atan2(frame.x.y, frame.x.x) - pose.theta_rad, 2.0 * kPi) ==
                Approx(0.0).margin(1e-12));
        REQUIRE(frame.z.z >= std::cos(std::atan(rough.steepest())) - 1e-12);
        const Vector3 v{.x = 0.3, .y = -0.7, .z = 1.1};
        REQUIRE(length(frame.seen(frame.turned(v)) - v) == Approx(0.0).margin(1e-12));
        most_rad = std::max(most_rad, angle_between(frame.z, kLevel));
    }
    CHECK(degrees(most_rad) > 5.0);
}

TEST_CASE("terrain: an IMU feels gravity, the turn and what keeps it on its circle") {
    constexpr double kTick_s = 0.01;
    constexpr double kSpeed_mps = 1.5;
    constexpr double kTurn_radps = 0.8;
    Pose2 pose;
    ImuModel imu(level_frame(pose));
    ImuRecord record = imu.update(level_frame(pose), kTick_s);
    CHECK(record.rate_radps == Vector3{});
    CHECK(record.force_mps2.z == Approx(9.80665));
    for (int tick = 0; tick < 100; ++tick) {
        const double turn_rad = kTurn_radps * kTick_s;
        pose = pose * Pose2{.x_m = kSpeed_mps * kTick_s * std::cos(turn_rad / 2.0),
                            .y_m = kSpeed_mps * kTick_s * std::sin(turn_rad / 2.0),
                            .theta_rad = turn_rad};
        record = imu.update(level_frame(pose), kTick_s);
    }
    CHECK(record.rate_radps.z == Approx(kTurn_radps).epsilon(1e-4));
    CHECK(record.force_mps2.y == Approx(kSpeed_mps * kTurn_radps).epsilon(0.02));
    CHECK(record.force_mps2.x == Approx(0.0).margin(0.02));
    CHECK(record.force_mps2.z == Approx(9.80665));
}

TEST_CASE("terrain: the core's filter finds from the IMU how the vehicle leans") {
    constexpr double kTick_s = 0.01;
    constexpr double kSpeed_mps = 1.0;
    const Terrain rough(radians(10.0));
    const auto stands = [&rough](const Pose2& pose) { return frame_on(rough, pose, kLength_m, kWidth_m); };
    const auto filter = std::make_unique<InertialFilter>();
    Pose2 pose;
    ImuModel imu(stands(pose));
    double worst_rad = 0.0;
    double worst_level_rad = 0.0;  // the control: of a filter that says "level"
    for (int tick = 1; tick <= 6000; ++tick) {
        const double now_s = tick * kTick_s;
        const double turn_rad = 0.3 * std::sin(0.2 * now_s) * kTick_s;
        const bool moves = now_s > 2.0;
        pose = moves ? pose * Pose2{.x_m = kSpeed_mps * kTick_s, .y_m = 0.0, .theta_rad = turn_rad} : pose;
        const Frame frame = stands(pose);
        const ImuRecord record = imu.update(frame, kTick_s);
        const Stamp stamp{static_cast<std::int64_t>(now_s * 1e9)};
        static_cast<void>(filter->add({.stamp = stamp,
                                       .yaw_rate_radps = record.rate_radps.z,
                                       .speed_mps = moves ? kSpeed_mps : 0.0,
                                       .inertial = Inertial{.roll_rate_radps = record.rate_radps.x,
                                                            .pitch_rate_radps = record.rate_radps.y,
                                                            .acceleration_x_mps2 = record.force_mps2.x,
                                                            .acceleration_y_mps2 = record.force_mps2.y,
                                                            .acceleration_z_mps2 = record.force_mps2.z}}));
        if (now_s > 5.0) {
            const Vector3 up = frame.seen(kLevel);
            worst_rad = std::max(worst_rad, angle_between(filter->attitude().up_at(stamp), up));
            worst_level_rad = std::max(worst_level_rad, angle_between(kLevel, up));
        }
    }
    CHECK(degrees(worst_rad) < 1.0);
    CHECK(degrees(worst_level_rad) > 4.0);
}

}  // namespace crspf::sim
