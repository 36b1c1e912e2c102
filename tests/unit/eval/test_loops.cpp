#include <catch2/catch.hpp>
#include <cmath>
#include <stdexcept>
#include <string>

#include "platform/files/input_error.hpp"
#include "tests/unit/eval/wall_scans.hpp"
#include "tests/unit/platform/scratch.hpp"
#include "tools/eval/logged_scans.hpp"
#include "tools/eval/loops.hpp"

using namespace crspf;
using namespace crspf::eval;
using Catch::Matchers::Contains;
using crspf::test::add_box;
using crspf::test::Scratch;
using crspf::test::wall_scan;
using crspf::test::Walls;

namespace {

constexpr double kTurn_m = 1.0;  // radius of the corners
constexpr double kLap_m = 2.0 * 6.0 + 2.0 * 4.0 + 2.0 * kPi * kTurn_m;
constexpr double kScanEvery_m = 0.1;

/// A hall of 14 m by 12 m with things in it, no two corners alike.
Walls hall() {
    Walls walls;
    add_box(walls, -3.0, -3.0, 11.0, 9.0);
    add_box(walls, 2.0, 2.0, 6.0, 3.5);
    add_box(walls, 9.5, -3.0, 11.0, -1.5);
    add_box(walls, 10.2, 4.0, 11.0, 5.1);
    add_box(walls, 1.0, 8.2, 3.3, 9.0);
    add_box(walls, -3.0, 5.0, -2.4, 6.0);
    add_box(walls, -2.2, -0.4, -1.9, 0.1);
    return walls;
}

struct Run {
    std::vector<LoggedScan> scans;
    std::vector<TimedPose> trajectory;
};

/// Round the middle of the hall, counter-clockwise: straight 6 m, a corner, 4 m, a corner, and so on.
Run drive(double path_m) {
    Run run;
    Rng rng(11);
    Pose2 pose;
    constexpr double kCorner_m = kPi / 2.0 * kTurn_m;
    const std::vector<double> straights_m = {6.0, 4.0};
    std::size_t side = 0;
    double on_side_m = 0.0;
    for (int i = 0; i * kScanEvery_m < path_m; ++i) {
        run.scans.push_back({.stamp_s = 0.1 * i, .hits = wall_scan(hall(), pose, rng)});
        run.trajectory.push_back({.stamp_s = 0.1 * i, .P_map_base = pose});
        constexpr int kParts = 100;
        for (int part = 0; part < kParts; ++part) {
            const double step_m = kScanEvery_m / kParts;
            const bool turning = on_side_m >= straights_m[side % 2];
            pose = pose * Pose2{.x_m = step_m, .y_m = 0.0, .theta_rad = turning ? step_m / kTurn_m : 0.0};
            on_side_m += step_m;
            if (on_side_m >= straights_m[side % 2] + kCorner_m) {
                on_side_m = 0.0;
                ++side;
            }
        }
    }
    return run;
}

/// From the second lap on the trajectory lies by `drift` beside the truth.
Run with_drift(Run run, const Pose2& drift) {
    for (std::size_t i = 0; i < run.trajectory.size(); ++i) {
        if (static_cast<double>(i) * kScanEvery_m > kLap_m - 1.6) {
            run.trajectory[i].P_map_base = drift * run.trajectory[i].P_map_base;
        }
    }
    return run;
}

}  // namespace

TEST_CASE("loops: the truth agrees with itself", "[eval][loops]") {
    const Run run = drive(2.0 * kLap_m);
    const LoopErrors errors = loop_errors(run.scans, run.trajectory);
    REQUIRE(errors.ends.size() == 1);
    const LoopEnd& end = errors.ends.front();
    CHECK(end.measured > end.revisits / 2);
    CHECK(end.measured == errors.position_m.count);
    CHECK(end.revisits == errors.revisits);
    CHECK(end.length_m == Approx(kLap_m).margin(2.0));
    CHECK(end.position_m < 0.02);
    CHECK(end.heading_deg < 0.3);
    CHECK(errors.position_m.max < 0.03);
}

TEST_CASE("loops: what drifted from lap to lap is found", "[eval][loops]") {
    const Pose2 drift = GENERATE(Pose2{.x_m = 0.4, .y_m = 0.0, .theta_rad = 0.0},
                                 Pose2{.x_m = -0.24, .y_m = 0.32, .theta_rad = radians(3.0)});
    const Run run = with_drift(drive(2.0 * kLap_m), drift);
    const LoopErrors errors = loop_errors(run.scans, run.trajectory);
    REQUIRE(errors.ends.size() == 1);
    const LoopEnd& end = errors.ends.front();
    REQUIRE(end.measured > 0);
    // The loop closes near the origin, about which the drift turns.
    CHECK(end.position_m == Approx(0.4).margin(0.4 * std::abs(drift.theta_rad) * 10.0 + 0.02));
    CHECK(end.heading_deg == Approx(degrees(drift.theta_rad)).margin(0.3));
    CHECK(errors.position_m.median > 0.2);
}

TEST_CASE("loops: stamps that run back do no harm", "[eval][loops]") {
    Run run = with_drift(drive(1.5 * kLap_m), {.x_m = 0.0, .y_m = 0.4, .theta_rad = 0.0});
    for (std::size_t i = 0; i < run.scans.size(); ++i) {
        run.scans[i].stamp_s = run.trajectory[i].stamp_s = i % 7 == 3 ? 5.0 : 1000.0 - static_cast<double>(i);
    }
    const LoopErrors errors = loop_errors(run.scans, run.trajectory);
    REQUIRE(errors.ends.size() == 1);
    CHECK(errors.ends.front().position_m == Approx(0.4).margin(0.02));
}

TEST_CASE("loops: a run without a revisit has none", "[eval][loops]") {
    const Run run = drive(0.5 * kLap_m);
    const LoopErrors errors = loop_errors(run.scans, run.trajectory);
    CHECK(errors.ends.empty());
    CHECK(errors.revisits == 0);
    CHECK(loop_errors({}, {}).ends.empty());
}

TEST_CASE("loops: each scan needs its pose", "[eval][loops]") {
    Run run = drive(1.0);
    CHECK_NOTHROW(require_pose_per_scan(run.scans, run.trajectory, "run.tum"));
    Run late = run;
    late.trajectory[3].stamp_s += 0.002;
    CHECK_THROWS_WITH(require_pose_per_scan(late.scans, late.trajectory, "run.tum"),
                      Contains("run.tum: pose 4") && Contains("0.302000"));
    run.trajectory.pop_back();
    CHECK_THROWS_AS(require_pose_per_scan(run.scans, run.trajectory, "run.tum"), InputError);
    CHECK_THROWS_WITH(require_pose_per_scan(run.scans, run.trajectory, "run.tum"),
                      Contains("run.tum: 9 poses for 10 scans"));
    CHECK_THROWS_AS(loop_errors(run.scans, run.trajectory), std::invalid_argument);
    CHECK_THROWS_AS(require_pose_per_scan(run.scans, {}, "run.tum"), InputError);
}

TEST_CASE("loops: scans of logs, in the order of the files", "[eval][loops]") {
    const Scratch scratch;
    const auto line = [](double stamp_s) {
        const std::string stamp = std::to_string(stamp_s);
        return "FLASER 3 1.0 2.0 81.83 0 0 0 0 0 0 " + stamp + " host " + stamp + "\n";
    };
    const auto first = scratch.file("first.clf", line(100.0) + line(99.0));
    const auto second = scratch.file("second.clf", line(7.0));
    const std::vector<LoggedScan> scans = read_scans({first, second}, {});
    REQUIRE(scans.size() == 3);
    CHECK(scans[0].stamp_s == 100.0);
    CHECK(scans[1].stamp_s == 99.0);
    CHECK(scans[2].stamp_s == 7.0);
    REQUIRE(scans[0].hits.points.size() == 2);  // the third saw nothing
    CHECK(scans[0].hits.points[0].norm() == Approx(1.0));
    Config config;
    config.slam.lidar.P_base_lidar.x_m = 0.25;
    CHECK(read_scans({first}, config)[0].hits.lidar.x() == 0.25);
}

TEST_CASE("loops: a log without a scan is an error", "[eval][loops]") {
    const Scratch scratch;
    CHECK_THROWS_AS(read_scans({scratch.file("empty.clf", "")}, {}), InputError);
    CHECK_THROWS_WITH(read_scans({scratch.file("odometry.clf", "ODOM 0 0 0 0 0 0 1.0 host 1.0\n")}, {}),
                      Contains("odometry.clf: no usable scan"));
    CHECK_THROWS_AS(read_scans({}, {}), InputError);
}
