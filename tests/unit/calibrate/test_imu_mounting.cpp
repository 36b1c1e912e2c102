// An IMU that is mounted askew, in a vehicle that drives bends.
#include "tools/calibrate/imu_mounting.hpp"

#include <catch2/catch.hpp>
#include <cmath>
#include <vector>

#include "core/base/rng.hpp"
#include "core/base/trig.hpp"

namespace {

using namespace crspf;

std::vector<ImuSample> ride(double yaw_rad, double bends_radps) {
    std::vector<ImuSample> samples;
    Rng random(3);
    for (int i = 0; i < 12000; ++i) {
        const double at_s = 0.01 * i;
        const double speed_mps = 10.0 + 4.0 * std::sin(at_s / 3.0);
        const double along = 4.0 / 3.0 * std::cos(at_s / 3.0);
        const double turn = bends_radps * std::sin(at_s / 5.0);
        const double across = speed_mps * turn;
        const auto shaken = [&](double value) { return value + 0.4 + 1.5 * random.symmetric(); };
        samples.push_back({.stamp = {static_cast<std::int64_t>(i) * 10'000'000},
                           .yaw_rate_radps = turn,
                           .speed_mps = speed_mps,
                           .inertial = Inertial{
                               .acceleration_x_mps2 = shaken(std::cos(yaw_rad) * along + std::sin(yaw_rad) * across),
                               .acceleration_y_mps2 = shaken(-std::sin(yaw_rad) * along + std::cos(yaw_rad) * across),
                               .acceleration_z_mps2 = 9.81}});
    }
    return samples;
}

}  // namespace

TEST_CASE("imu mounting: the yaw is found in whatever direction it points, through shaking and a bias") {
    for (const double yaw_deg : {0.0, 12.0, -95.0, 171.0}) {
        const auto found = calibrate::imu_yaw(ride(radians(yaw_deg), 0.2));
        REQUIRE(found);
        INFO(yaw_deg << ": " << degrees(found->value) << " +- " << degrees(found->stddev));
        CHECK(std::abs(wrap_angle(found->value - radians(yaw_deg))) < 4.0 * found->stddev);
        CHECK(found->stddev < radians(2.0));
    }
}

TEST_CASE("imu mounting: without accelerations, or a drive, there is nothing to find") {
    CHECK_FALSE(calibrate::imu_yaw({}));
    std::vector<ImuSample> plain = ride(0.0, 0.2);
    for (ImuSample& sample : plain) {
        sample.inertial.reset();
    }
    CHECK_FALSE(calibrate::imu_yaw(plain));
    std::vector<ImuSample> stands = ride(0.0, 0.0);
    for (ImuSample& sample : stands) {
        sample.speed_mps = 0.0;
    }
    const auto unknown = calibrate::imu_yaw(stands);
    REQUIRE(unknown);
    CHECK(unknown->stddev > radians(30.0));
}

TEST_CASE("imu mounting: standing still tells the bias") {
    std::vector<ImuSample> samples = ride(0.0, 0.0);
    CHECK_FALSE(calibrate::standing_bias(samples));
    for (std::size_t i = 0; i < samples.size(); ++i) {
        samples[i].yaw_rate_radps = radians(0.5) + (i % 2 == 0 ? 0.01 : -0.01);
        samples[i].speed_mps = i < 6000 ? 0.0 : 1.0;
        samples[i].yaw_rate_radps += i < 6000 ? 0.0 : 1.0;
    }
    const auto found = calibrate::standing_bias(samples);
    REQUIRE(found);
    CHECK(found->value == Approx(radians(0.5)).margin(1e-4));
    CHECK(found->stddev < radians(0.02));
}
