// A vehicle that tells no speed: what the poses that the filter finds make of it.
#include <catch2/catch.hpp>
#include <cmath>
#include <optional>

#include "core/base/rng.hpp"
#include "core/base/trig.hpp"
#include "core/odometry/motion_models.hpp"
#include "core/odometry/odometry.hpp"

namespace {

using namespace crspf;

constexpr double kGravity = 9.80665;

/// Stands, speeds up to 2 m/s within 2 s, drives a bend, brakes, reverses.
double true_speed_mps(double s) {
    return s < 2.0 ? 0.0 : s < 4.0 ? s - 2.0 : s < 10.0 ? 2.0 : s < 13.0 ? 12.0 - s : -1.0;
}
constexpr double kTurn_radps = 0.2;

struct Errors {
    double speed_mps = 0.0;  ///< largest while the speed is steady
    double pose_m = 0.0;     ///< largest of P~ at a scan
    double stddevs = 0.0;    ///< the same, in standard deviations of the motion since the scan before
};

/// Samples at 100 Hz; a pose each 0.1 s that comes 0.13 s late.
Errors ride(bool six_axes, bool feedback) {
    Odometry odometry{OdometryParams{}};
    Rng rng(5);
    Errors errors;
    Pose2 truth;
    std::optional<Stamp> scan;
    Pose2 P_map_scan;
    Stamp before;
    for (int i = 1; i <= 1600; ++i) {
        const double s = 0.01 * i;
        const double speed_mps = true_speed_mps(s);
        truth = truth * arc(0.01 * 0.5 * (true_speed_mps(s - 0.01) + speed_mps), 0.01 * kTurn_radps);
        ImuSample sample{.stamp = Stamp{i * 10'000'000LL}, .yaw_rate_radps = kTurn_radps, .speed_told = false};
        if (six_axes) {
            const double forward_mps2 = (true_speed_mps(s + 1e-4) - true_speed_mps(s - 1e-4)) / 2e-4;
            sample.inertial = Inertial{.acceleration_x_mps2 = forward_mps2 + 0.1 + 0.2 * rng.symmetric(),
                                       .acceleration_y_mps2 = kTurn_radps * speed_mps + 0.2 * rng.symmetric(),
                                       .acceleration_z_mps2 = kGravity + 0.2 * rng.symmetric()};
        }
        odometry.add(sample);
        if (i % 10 == 0) {
            scan = sample.stamp;
            P_map_scan = truth;
        }
        if (i % 10 == 3 && scan) {
            const Pose2 observed = odometry.pose_at(*scan);
            const double off_m = std::hypot(observed.x_m - P_map_scan.x_m, observed.y_m - P_map_scan.y_m);
            errors.pose_m = std::max(errors.pose_m, off_m);
            if (before != Stamp{}) {
                errors.stddevs =
                    std::max(errors.stddevs, off_m / odometry.motion_between(before, *scan).translation_stddev_m);
            }
            before = *scan;
            if (feedback) {
                odometry.correct(*scan, {.x_m = P_map_scan.x_m + 0.005 * rng.symmetric(),
                                         .y_m = P_map_scan.y_m + 0.005 * rng.symmetric(),
                                         .theta_rad = P_map_scan.theta_rad});
            }
            const bool steady = (s > 6.0 && s < 10.0) || s > 14.0;
            errors.speed_mps = steady && feedback
                                   ? std::max(errors.speed_mps, std::abs(odometry.estimated_speed_mps() - speed_mps))
                                   : errors.speed_mps;
        }
    }
    return errors;
}

}  // namespace

TEST_CASE("speed estimate: found from the corrections, and the odometry's doubt is as large as its error") {
    for (const bool six_axes : {false, true}) {
        const Errors errors = ride(six_axes, true);
        CAPTURE(six_axes, errors.speed_mps, errors.pose_m, errors.stddevs);
        CHECK(errors.speed_mps < 0.2);
        CHECK(errors.pose_m < 0.06);
        CHECK(errors.stddevs < 3.0);
        CHECK(ride(six_axes, false).pose_m > 1.0);  // who learns nothing of the scans loses the way
    }
}

TEST_CASE("speed estimate: a robot that is placed elsewhere has not driven there") {
    Odometry odometry{OdometryParams{}};
    Pose2 at;
    for (int i = 1; i <= 400; ++i) {
        const Stamp stamp{i * 10'000'000LL};
        odometry.add(ImuSample{.stamp = stamp, .yaw_rate_radps = 0.0, .speed_told = false});
        at.x_m += 0.005;
        if (i % 10 == 0) {
            odometry.correct(stamp, at);
        }
        if (i == 295) {
            at = {.x_m = -7.0, .y_m = 3.0, .theta_rad = 0.0};
            odometry.set_pose(at);
        }
        if (i == 345) {
            at.x_m += 4.0;  // the filter's word alone
        }
        if (i > 200) {
            CHECK(odometry.estimated_speed_mps() == Approx(0.5).margin(0.1));
        }
    }
}

TEST_CASE("speed estimate: a speed that is told is used as before") {
    Odometry odometry{OdometryParams{}};
    for (int i = 0; i <= 100; ++i) {
        const Stamp stamp{i * 10'000'000LL};
        odometry.add(ImuSample{.stamp = stamp, .yaw_rate_radps = 0.0, .speed_mps = 1.0});
        odometry.correct(stamp, {.x_m = 0.02 * i});
    }
    CHECK(odometry.estimated_speed_mps() == 0.0);
    CHECK(odometry.motion_between(Stamp{0}, Stamp{1'000'000'000}).P_from_to.x_m == Approx(1.0));
}
