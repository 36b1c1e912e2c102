// An odometer that is blind goes on saying that the robot drives, though it has braked: by the doubt that it tells
// beside, the robot is found all the same.
#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <memory>

#include "core/base/real.hpp"
#include "core/slam/pipeline.hpp"
#include "tests/unit/core/synthetic.hpp"

using namespace crspf;
using namespace crspf::test;

namespace {

constexpr double kSpeed_mps = 1.5;
constexpr Duration kScanPeriod{100'000'000};
constexpr double kFound_m = 0.08;

/// Along its long walls a wrong way is hardly seen.
Walls hall() {
    Walls walls = square_room(6.0);
    add_box(walls, -1.0, 2.0, 0.5, 3.0);
    add_box(walls, 2.5, -4.0, 3.0, -2.5);
    add_box(walls, -6.0, 4.0, -4.5, 6.0);
    return walls;
}

/// A robot that drives along x, what its odometer says, and its lidar at 10 Hz.
class Robot {
 public:
    Robot() : pipeline_(make_large<Pipeline>(SlamParams{})) {
        pipeline_->set_pose(P_map_base());
        for (const double step_m : {0.05, -0.05}) {  // there and back, slowly: a good map
            drive(step_m, 140);
        }
        drive(kSpeed_mps * kScanPeriod.seconds(), 20);
    }

    /// It stands, and its odometer guesses a motion.
    void guess(Duration time, const Pose2& step, double stddev_m) {
        stamp_ = stamp_ + time;
        pipeline_->on_motion(
            {.stamp = stamp_, .P_previous_base = step, .translation_variance_m2 = square(stddev_m), .blind = true});
        scan();
    }
    [[nodiscard]] double error_m() const {
        return std::hypot(last_.P_map_base.x_m - P_map_base().x_m, last_.P_map_base.y_m - P_map_base().y_m);
    }

 private:
    [[nodiscard]] Pose2 P_map_base() const { return {.x_m = x_m_, .y_m = -1.0, .theta_rad = 0.0}; }
    void drive(double step_m, int scans) {
        for (int i = 0; i < scans; ++i) {
            x_m_ += step_m;
            stamp_ = stamp_ + kScanPeriod;
            pipeline_->on_motion({.stamp = stamp_, .P_previous_base = {.x_m = step_m}});
            scan();
        }
    }
    void scan() {
        Scan scan = beams_of(361, radians(-135.0), radians(135.0));
        scan.stamp = stamp_;
        measure_at(scan, walls_, P_map_base());
        last_ = pipeline_->on_scan(scan);
    }

    std::unique_ptr<Pipeline> pipeline_;
    Walls walls_ = hall();
    double x_m_ = -4.0;
    Stamp stamp_{1'000'000'000};
    ScanResult last_;
};

/// The speed held for two seconds. @param stddev_mps that the odometer tells of it @return the largest error
double worst_error_m(double stddev_mps) {
    Robot robot;
    double worst_m = robot.error_m();
    for (int i = 0; i < 20; ++i) {
        const double dt_s = kScanPeriod.seconds();
        robot.guess(kScanPeriod, {.x_m = kSpeed_mps * dt_s}, stddev_mps * dt_s);
        worst_m = std::max(worst_m, robot.error_m());
    }
    return worst_m;
}

}  // namespace

TEST_CASE("blind: the speed is held though the robot has braked") {
    CHECK(worst_error_m(1.0) < kFound_m);
    CHECK(worst_error_m(2.0) < kFound_m);
    CHECK(worst_error_m(0.0) > 1.0);  // control: who is sure of a wrong motion is believed
}

TEST_CASE("blind: the lidar, too, for two seconds") {
    constexpr Duration kSpell{2'000'000'000};
    for (const Pose2 guessed :
         {Pose2{.x_m = 0.6}, Pose2{.x_m = -0.6}, Pose2{.y_m = -0.8}, Pose2{.x_m = 0.3, .y_m = 0.3}}) {
        INFO(guessed.x_m << ", " << guessed.y_m);
        Robot robot;
        REQUIRE(robot.error_m() < kFound_m);
        robot.guess(kSpell, guessed, 0.3);
        CHECK(robot.error_m() < kFound_m);
        Robot sure;
        sure.guess(kSpell, guessed, 0.0);
        CHECK(sure.error_m() > 0.2);  // control
    }
}
