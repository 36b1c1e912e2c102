#include <catch2/catch.hpp>
#include <cmath>
#include <limits>

#include "core/base/rng.hpp"
#include "core/base/trig.hpp"
#include "core/odometry/inertial.hpp"
#include "core/odometry/odometry.hpp"

using namespace crspf;

namespace {

constexpr double kGravity = 9.80665;  // [m/s^2]
constexpr double kPeriod_s = 0.01;

/// Roll, pitch and heading of a vehicle and its speed, as functions of time, and what an IMU of six axes says of them.
struct Ride {
    double roll_rad(double s) const { return amplitude_rad * std::sin(2.0 * s); }
    double pitch_rad(double s) const { return amplitude_rad * std::sin(1.3 * s + 0.4); }
    double speed_mps(double s) const { return s < stands_s ? 0.0 : 3.0 - 3.0 * std::cos(0.2 * (s - stands_s)); }

    Vector3 up(double s) const {
        return {.x = -std::sin(pitch_rad(s)),
                .y = std::cos(pitch_rad(s)) * std::sin(roll_rad(s)),
                .z = std::cos(pitch_rad(s)) * std::cos(roll_rad(s))};
    }

    ImuSample sample(double s) const {
        constexpr double kStep = 1e-5;
        const auto slope = [&](auto f) { return (f(s + kStep) - f(s - kStep)) / (2.0 * kStep); };
        const double roll_rate = slope([&](double t) { return roll_rad(t); });
        const double pitch_rate = slope([&](double t) { return pitch_rad(t); });
        const double heading_rate = s < stands_s ? 0.0 : heading_rate_radps;
        const double sin_roll = std::sin(roll_rad(s));
        const double cos_roll = std::cos(roll_rad(s));
        const double cos_pitch = std::cos(pitch_rad(s));
        // Rates in the vehicle's axes, from those of the angles about z, y, x in turn.
        const Vector3 rate{.x = roll_rate - std::sin(pitch_rad(s)) * heading_rate,
                           .y = cos_roll * pitch_rate + sin_roll * cos_pitch * heading_rate,
                           .z = -sin_roll * pitch_rate + cos_roll * cos_pitch * heading_rate};
        const double v = speed_mps(s);
        const Vector3 driving{.x = slope([&](double t) { return speed_mps(t); }), .y = rate.z * v, .z = -rate.y * v};
        const Vector3 force = kGravity * up(s) + driving;
        return {.stamp = Stamp{} + Duration::from_seconds(s),
                .yaw_rate_radps = rate.z + bias_radps.z,
                .speed_mps = v,
                .inertial = Inertial{.roll_rate_radps = rate.x + bias_radps.x,
                                     .pitch_rate_radps = rate.y + bias_radps.y,
                                     .acceleration_x_mps2 = force.x,
                                     .acceleration_y_mps2 = force.y,
                                     .acceleration_z_mps2 = force.z}};
    }

    double amplitude_rad = radians(6.0);
    double heading_rate_radps = 0.3;
    double stands_s = 0.0;
    Vector3 bias_radps{};
};

double tilt_between(const Vector3& a, const Vector3& b) {
    return std::asin(std::min(length(cross(a, b)), 1.0));
}

/// The largest error of up from `from_s` on.
double worst_tilt_rad(InertialFilter& filter, const Ride& ride, double from_s, double to_s) {
    double worst_rad = 0.0;
    for (int i = 0; i < std::lround(to_s / kPeriod_s); ++i) {
        const double s = i * kPeriod_s;
        static_cast<void>(filter.add(ride.sample(s)));
        if (s >= from_s) {
            const Stamp stamp = Stamp{} + Duration::from_seconds(s);
            worst_rad = std::max(worst_rad, tilt_between(filter.attitude().up_at(stamp), ride.up(s)));
        }
    }
    return worst_rad;
}

}  // namespace

TEST_CASE("inertial: up is known on a ride that pitches, rolls, turns and changes its speed") {
    InertialFilter filter;
    CHECK(worst_tilt_rad(filter, Ride{}, 10.0, 60.0) < radians(0.4));
}

TEST_CASE("inertial: a bias of the gyroscope is learnt, standing and on the move") {
    const Vector3 bias{.x = radians(0.8), .y = radians(-0.6), .z = 0.0};
    InertialFilter moving;
    CHECK(worst_tilt_rad(moving, Ride{.bias_radps = bias}, 120.0, 180.0) < radians(0.5));
    CHECK(moving.bias_radps().x == Approx(bias.x).margin(radians(0.1)));
    CHECK(moving.bias_radps().y == Approx(bias.y).margin(radians(0.1)));

    InertialFilter standing;
    static_cast<void>(
        worst_tilt_rad(standing, Ride{.amplitude_rad = 0.0, .stands_s = 100.0, .bias_radps = bias}, 8.0, 12.0));
    CHECK(standing.bias_radps().x == Approx(bias.x).margin(radians(0.05)));
    CHECK(standing.bias_radps().y == Approx(bias.y).margin(radians(0.05)));
}

TEST_CASE("inertial: the heading turns as fast as it does, whatever the tilt") {
    InertialFilter filter;
    const Ride ride{.amplitude_rad = radians(12.0)};
    double plain_rad = 0.0;
    double heading_rad = 0.0;
    double way_m = 0.0;
    for (int i = 0; i < std::lround(60.0 / kPeriod_s); ++i) {
        const double s = i * kPeriod_s;
        const ImuSample sample = ride.sample(s);
        const ImuSample level = filter.add(sample);
        plain_rad += sample.yaw_rate_radps * kPeriod_s;
        heading_rad += level.yaw_rate_radps * kPeriod_s;
        way_m += (level.speed_mps - sample.speed_mps * std::cos(ride.pitch_rad(s))) * kPeriod_s;
        CHECK_FALSE(level.inertial);
    }
    CHECK(heading_rad == Approx(0.3 * 60.0).margin(0.01));
    CHECK(std::abs(plain_rad - 0.3 * 60.0) > 0.1);  // without levelling
    CHECK(way_m == Approx(0.0).margin(0.05));
}

TEST_CASE("inertial: gaps, stuck axes and damaged numbers are counted and do no harm") {
    InertialFilter filter;
    const Ride ride;
    static_cast<void>(worst_tilt_rad(filter, ride, 0.0, 20.0));
    const Vector3 before = filter.attitude().up_at(Stamp{} + Duration::from_seconds(20.0));
    ImuSample damaged = ride.sample(20.0);
    damaged.inertial->acceleration_x_mps2 = std::numeric_limits<double>::quiet_NaN();
    CHECK(filter.add(damaged).yaw_rate_radps == damaged.yaw_rate_radps);
    damaged = ride.sample(20.0);
    damaged.inertial->acceleration_z_mps2 = 1e300;
    static_cast<void>(filter.add(damaged));
    damaged = ride.sample(20.0);
    damaged.inertial->roll_rate_radps = -1e200;
    static_cast<void>(filter.add(damaged));
    CHECK(filter.counters().damaged == 3);
    CHECK(filter.attitude().up_at(damaged.stamp) == before);

    static_cast<void>(filter.add(ride.sample(25.0)));
    CHECK(filter.counters().gaps == 1);
    for (int i = 0; i < 100; ++i) {
        ImuSample stuck = ride.sample(25.0);
        stuck.stamp = stuck.stamp + Duration::from_seconds(0.01 * (i + 1));
        static_cast<void>(filter.add(stuck));
    }
    CHECK(filter.counters().stuck > 70);
    // It falls: nothing is said of up.
    InertialFilter falling;
    ImuSample weightless = ride.sample(0.0);
    weightless.inertial->acceleration_z_mps2 = 0.0;
    weightless.inertial->acceleration_y_mps2 = 0.0;
    static_cast<void>(falling.add(weightless));
    CHECK(falling.attitude().up_at(weightless.stamp) == kLevel);
}

TEST_CASE("attitude history: interpolated between, held beyond, level before") {
    AttitudeHistory history;
    CHECK(history.up_at(Stamp{5}) == kLevel);
    for (int i = 1; i <= 3000; ++i) {
        history.add(Stamp{i * 1000LL}, {.x = 0.001 * i, .y = 0.0, .z = 1.0});
    }
    CHECK(history.up_at(Stamp{2500500}).x == Approx(2.5005));
    CHECK(history.up_at(Stamp{9000000}).x == Approx(3.0));
    CHECK(history.up_at(Stamp{0}).x == Approx(0.001 * (3000 - capacity::kAttitudes + 1)));
    history.add(Stamp{1000}, kLevel);  // runs back
    CHECK(history.up_at(Stamp{9000000}).x == Approx(3.0));
}

TEST_CASE("odometry: the bias of a yaw rate is learnt standing, and on the move from the corrections") {
    const double bias_radps = radians(0.5);
    Odometry standing{OdometryParams{}};
    for (int i = 0; i < 1000; ++i) {
        standing.add(ImuSample{.stamp = Stamp{i * 10'000'000LL}, .yaw_rate_radps = bias_radps, .speed_mps = 0.0});
    }
    CHECK(standing.yaw_rate_bias_radps() == Approx(bias_radps).epsilon(0.02));

    Odometry moving{OdometryParams{}};
    Rng rng(7);
    for (int i = 1; i <= 12000; ++i) {
        const Stamp stamp{i * 10'000'000LL};
        moving.add(ImuSample{.stamp = stamp, .yaw_rate_radps = bias_radps, .speed_mps = 1.0});
        if (i % 10 == 0) {  // the truth drives straight on; the filter knows it to a quarter of a degree
            moving.correct(stamp, {.x_m = 0.01 * i, .y_m = 0.0, .theta_rad = radians(0.25) * rng.symmetric()});
        }
    }
    CHECK(moving.yaw_rate_bias_radps() == Approx(bias_radps).epsilon(0.15));

    // A robot that turns on the spot is not taken for one that stands; nor are corrections that jump a bias.
    Odometry turning{OdometryParams{}};
    for (int i = 1; i < 1000; ++i) {
        turning.add(ImuSample{.stamp = Stamp{i * 10'000'000LL}, .yaw_rate_radps = 0.4, .speed_mps = 0.0});
        turning.correct(Stamp{i * 10'000'000LL}, {.x_m = 0.0, .y_m = 0.0, .theta_rad = i % 2 == 0 ? 1.0 : 2.0});
    }
    CHECK(turning.yaw_rate_bias_radps() == 0.0);
}
