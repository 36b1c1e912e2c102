// A vehicle with known constants drives, and they are found again.
#include "tools/calibrate/estimate.hpp"

#include <catch2/catch.hpp>
#include <cmath>
#include <functional>
#include <vector>

#include "core/base/rng.hpp"
#include "core/base/trig.hpp"
#include "core/odometry/motion_models.hpp"

namespace {

using namespace crspf;
using namespace crspf::calibrate;

constexpr double kStep_s = 0.02;
constexpr double kDrive_s = 180.0;
constexpr double kSpeed_mps = 0.5;
constexpr Pose2 kLidar{.x_m = 0.15, .y_m = -0.04, .theta_rad = radians(3.0)};
constexpr double kLate_s = 0.03;  ///< the scans' stamps

double winding(double at_s) {
    return 0.9 * std::sin(at_s / 2.0) + 0.3 * std::sin(at_s / 5.1);
}
double straight(double /*at_s*/) {
    return 0.0;
}

/// A drive with this turn rate; `tell` makes the odometer's sample of each step.
Drive drive(const std::function<double(double)>& turn_radps, double noise_m,
            const std::function<void(Drive&, Stamp, double)>& tell) {
    Drive drive;
    Rng random(7);
    const auto noise = [&](double scale) {
        double sum = 0.0;  // of twelve: nearly normal
        for (int i = 0; i < 12; ++i) {
            sum += 0.5 * random.symmetric();
        }
        return scale * sum;
    };
    Pose2 P_world_base;
    Pose2 P_begin;
    Stamp begin;
    Stamp now;
    double way_m = 0.0;
    for (int step = 0; step * kStep_s < kDrive_s; ++step) {
        const double turn = turn_radps(step * kStep_s);
        P_world_base = P_world_base * arc(kSpeed_mps * kStep_s, turn * kStep_s);
        now = now + Duration::from_seconds(kStep_s);
        tell(drive, now, turn);
        way_m += kSpeed_mps * kStep_s;
        if (way_m < 0.6) {
            continue;
        }
        way_m = 0.0;
        const Pose2 lidar = P_world_base * kLidar;
        const Stamp stamped = now + Duration::from_seconds(kLate_s);
        if (begin != Stamp{}) {
            const Pose2 moved = inverse(P_begin) * lidar;
            drive.pieces.push_back({.from = begin,
                                    .to = stamped,
                                    .P_from_to = {.x_m = moved.x_m + noise(noise_m),
                                                  .y_m = moved.y_m + noise(noise_m),
                                                  .theta_rad = moved.theta_rad + noise(noise_m / 2.0)}});
            begin = Stamp{};
        } else {
            begin = stamped;
            P_begin = lidar;
        }
    }
    return drive;
}

/// A rate is told for the middle of its step.
Stamp middle(Stamp end) {
    return end - Duration::from_seconds(kStep_s / 2.0);
}

void tell_wheels(Drive& drive, Stamp now, double turn_radps) {
    constexpr double kSpan_m = 0.35;
    const double way_m = kSpeed_mps * kStep_s;
    const double across_m = turn_radps * kStep_s * kSpan_m / 2.0;
    drive.wheels.push_back({.stamp = now, .left_m = (way_m - across_m) / 1.02, .right_m = (way_m + across_m) / 0.99});
}

void check(const std::optional<Calibration>& found, const std::vector<double>& truth, double stddevs) {
    REQUIRE(found);
    REQUIRE(found->estimates.size() == truth.size());
    for (std::size_t i = 0; i < truth.size(); ++i) {
        const Estimate& estimate = found->estimates[i];
        INFO("unknown " << i << ": " << estimate.value << " +- " << estimate.stddev << ", in truth " << truth[i]);
        CHECK(std::abs(estimate.value - truth[i]) < stddevs * estimate.stddev + 1e-3);
    }
}

}  // namespace

TEST_CASE("estimate: two wheels, and the lidar they carry") {
    const std::vector<double> start{1.0, 1.0, 0.33, 0.0, 0.0, 0.0, 0.0};
    const std::vector<double> truth{1.02, 0.99, 0.35, kLidar.x_m, kLidar.y_m, kLidar.theta_rad, -kLate_s};
    check(estimate(drive(winding, 0.0, tell_wheels), Odometer::kWheels, start), truth, 0.0);
    const auto noisy = estimate(drive(winding, 0.01, tell_wheels), Odometer::kWheels, start);
    check(noisy, truth, 3.5);
    for (const Estimate& e : noisy->estimates) {
        CHECK(e.stddev > 1e-5);
        CHECK(e.stddev < 0.02);
    }
}

TEST_CASE("estimate: speed and steering angle") {
    const auto tell = [](Drive& drive, Stamp now, double turn_radps) {
        drive.car.push_back({.stamp = middle(now),
                             .speed_mps = kSpeed_mps / 1.05,
                             .steering_rad = std::atan(0.4 * turn_radps / kSpeed_mps) - radians(2.0)});
    };
    check(estimate(drive(winding, 0.0, tell), Odometer::kCar, std::vector<double>{1.0, 0.5, 0.0, 0.0, 0.0, 0.0, 0.0}),
          {1.05, 0.4, radians(2.0), kLidar.x_m, kLidar.y_m, kLidar.theta_rad, -kLate_s}, 3.5);
}

TEST_CASE("estimate: speed and yaw rate") {
    const auto tell = [](Drive& drive, Stamp now, double turn_radps) {
        drive.imu.push_back(
            {.stamp = middle(now), .yaw_rate_radps = turn_radps + radians(0.5), .speed_mps = kSpeed_mps / 0.97});
    };
    check(estimate(drive(winding, 0.0, tell), Odometer::kImu, std::vector<double>{1.0, 0.0, 0.0, 0.0, 0.0, 0.0}),
          {0.97, radians(0.5), kLidar.x_m, kLidar.y_m, kLidar.theta_rad, -kLate_s}, 3.5);
}

TEST_CASE("estimate: what a drive does not show is said to be unknown") {
    const std::vector<double> start{1.0, 1.0, 0.33, 0.0, 0.0, 0.0, 0.0};
    const auto found = estimate(drive(straight, 0.01, tell_wheels), Odometer::kWheels, start);
    REQUIRE(found);
    const std::span<const Unknown> unknowns = unknowns_of(Odometer::kWheels);
    for (std::size_t i = 0; i < unknowns.size(); ++i) {
        INFO(unknowns[i].key << " +- " << found->estimates[i].stddev);
        const bool shown = unknowns[i].key == "left_wheel_factor" || unknowns[i].key == "right_wheel_factor" ||
                           unknowns[i].key == "yaw_deg";
        CHECK((found->estimates[i].stddev <= unknowns[i].wanted) == shown);
    }
}

TEST_CASE("estimate: pieces that are wrong altogether do not pull it away") {
    Drive run = drive(winding, 0.005, tell_wheels);
    for (std::size_t i = 0; i < run.pieces.size(); i += 10) {
        run.pieces[i].P_from_to.x_m += 0.5;
        run.pieces[i].P_from_to.theta_rad -= 0.4;
    }
    check(estimate(run, Odometer::kWheels, std::vector<double>{1.0, 1.0, 0.33, 0.0, 0.0, 0.0, 0.0}),
          {1.02, 0.99, 0.35, kLidar.x_m, kLidar.y_m, kLidar.theta_rad, -kLate_s}, 5.0);
}

TEST_CASE("estimate: too little, or of another time, is nothing") {
    const std::vector<double> start{1.0, 1.0, 0.33, 0.0, 0.0, 0.0, 0.0};
    Drive run = drive(winding, 0.0, tell_wheels);
    Drive few = run;
    few.pieces.resize(10);
    CHECK_FALSE(estimate(few, Odometer::kWheels, start));
    for (Piece& piece : run.pieces) {
        piece.from = piece.from + Duration::from_seconds(1000.0);
        piece.to = piece.to + Duration::from_seconds(1000.0);
    }
    CHECK_FALSE(estimate(run, Odometer::kWheels, start));
    CHECK_FALSE(estimate(Drive{}, Odometer::kImu, std::vector<double>(6, 1.0)));
}
