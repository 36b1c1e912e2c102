#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <limits>

#include "core/odometry/motion_models.hpp"
#include "core/slam/scan_points.hpp"
#include "tests/unit/core/synthetic.hpp"

using namespace crspf;
using namespace crspf::test;

namespace {

constexpr double kSpeed_mps = 1.0;
constexpr double kYawRate_radps = 1.2;
constexpr Stamp kStart{5'000'000'000};

/// The true pose so many seconds after kStart; the robot drives a circle throughout.
Pose2 truth(double seconds) {
    return Pose2{.x_m = 0.3, .y_m = -0.2, .theta_rad = 0.4} * imu_motion(kSpeed_mps, kYawRate_radps, seconds);
}

/// An odometer at 100 Hz that tells the truth, from 0.5 s before kStart to 0.5 s after.
Odometry true_odometry() {
    Odometry odometry({});
    Pose2 before = truth(-0.5);
    odometry.set_pose(before);
    for (int i = -50; i <= 50; ++i) {
        const Pose2 now = truth(0.01 * i);
        odometry.add(
            MotionSample{.stamp = kStart + Duration::from_seconds(0.01 * i), .P_previous_base = inverse(before) * now});
        before = now;
    }
    return odometry;
}

/// Greatest distance of the points, placed by the true pose at the scan's stamp, from the wall x = 4.
double farthest_from_wall(const ScanPoints& points, double wall_x_m) {
    double worst = 0.0;
    for (std::uint32_t i = 0; i < points.count; ++i) {
        const Pose2 point =
            truth(0.0) * Pose2{.x_m = static_cast<double>(points.x_m[i]), .y_m = static_cast<double>(points.y_m[i])};
        worst = std::max(worst, std::abs(point.x_m - wall_x_m));
    }
    return worst;
}

}  // namespace

TEST_CASE("with de-skew the points of a moving robot lie on the wall, without they do not") {
    constexpr double kWall_m = 4.0;
    const Walls walls{{kWall_m, -30.0, kWall_m, 30.0}};
    LidarParams lidar;
    lidar.P_base_lidar = {.x_m = 0.2, .y_m = 0.05, .theta_rad = 0.1};
    const Odometry odometry = true_odometry();
    Scan scan = beams_of(541, radians(-60.0), radians(60.0));
    scan.stamp = kStart;
    // A scan that runs in time, and one whose beam 0 was measured last.
    scan.time_per_beam_s = GENERATE(0.1 / 541, -0.1 / 541);
    measure(scan, walls, [&](double seconds) { return truth(seconds) * lidar.P_base_lidar; });

    auto points = std::make_unique<ScanPoints>();
    ScanProjector deskewing(lidar, true);
    deskewing.project(scan, odometry, *points);
    REQUIRE(points->count > 300);
    CHECK(farthest_from_wall(*points, kWall_m) < 0.002);
    const Pose2 last = inverse(truth(0.0)) * truth(541 * scan.time_per_beam_s) * lidar.P_base_lidar;
    CHECK(points->P_base_first_lidar == lidar.P_base_lidar);
    CHECK(std::hypot(points->P_base_last_lidar.x_m - last.x_m, points->P_base_last_lidar.y_m - last.y_m) < 0.001);

    ScanProjector rigid(lidar, false);
    rigid.project(scan, odometry, *points);
    CHECK(farthest_from_wall(*points, kWall_m) > 0.05);
    CHECK(points->P_base_last_lidar == lidar.P_base_lidar);
}

TEST_CASE("a scan without time per beam is taken at once") {
    const Odometry odometry = true_odometry();
    Scan scan = beams_of(100, -1.0, 1.0);
    scan.stamp = kStart;
    measure_at(scan, {{4.0, -30.0, 4.0, 30.0}}, truth(0.0));
    auto points = std::make_unique<ScanPoints>();
    ScanProjector projector({}, true);
    projector.project(scan, odometry, *points);
    REQUIRE(points->count == 100);
    CHECK(farthest_from_wall(*points, 4.0) < 1e-5);
}

TEST_CASE("each kind of beam goes where it belongs") {
    Scan scan = beams_of(4, 0.0, 3.0 * kPi / 2.0);
    scan.beam = {Beam::kHit, Beam::kNoReturn, Beam::kInvalid, Beam::kHit};
    scan.range_m = {2.0F, 7.0F, 7.0F, 3.0F};
    LidarParams lidar;
    lidar.P_base_lidar = {.x_m = 0.5, .y_m = 0.0, .theta_rad = kPi / 2.0};
    auto points = std::make_unique<ScanPoints>();
    ScanProjector projector(lidar, true);
    projector.project(scan, Odometry({}), *points);
    CHECK(points->beams == 4);
    REQUIRE(points->count == 2);
    CHECK(points->beam[0] == 0);
    CHECK(static_cast<double>(points->x_m[0]) == Approx(0.5));
    CHECK(static_cast<double>(points->y_m[0]) == Approx(2.0));
    CHECK(points->range_m[0] == 2.0F);
    CHECK(points->beam[1] == 3);
    CHECK(static_cast<double>(points->x_m[1]) == Approx(3.5));
    CHECK(static_cast<double>(points->y_m[1]) == Approx(0.0).margin(1e-6));
    REQUIRE(points->clear_count == 1);
    CHECK(static_cast<double>(points->clear_x_m[0]) == Approx(-0.5));
    CHECK(static_cast<double>(points->clear_y_m[0]) == Approx(0.0).margin(1e-6));
}

TEST_CASE("the directions follow a scan whose beams change") {
    auto points = std::make_unique<ScanPoints>();
    ScanProjector projector({}, true);
    for (const double first_rad : {0.0, 0.5, 0.5}) {
        for (const std::uint32_t count : {2U, 3U, 2U}) {
            Scan scan = beams_of(count, first_rad, first_rad + 1.0);
            measure_at(scan, square_room(2.0), {});
            projector.project(scan, Odometry({}), *points);
            REQUIRE(points->count == count);
            for (std::uint32_t i = 0; i < count; ++i) {
                const double angle = first_rad + i * scan.angle_increment_rad;
                CHECK(std::atan2(static_cast<double>(points->y_m[i]), static_cast<double>(points->x_m[i])) ==
                      Approx(angle).margin(1e-6));
            }
        }
    }
}

TEST_CASE("damaged scans give no damaged points") {
    constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
    constexpr float kInfinity = std::numeric_limits<float>::infinity();
    auto points = std::make_unique<ScanPoints>();
    ScanProjector projector({}, true);
    const Odometry odometry = true_odometry();
    Scan scan = beams_of(64, -1.0, 1.0);
    scan.stamp = kStart;
    scan.time_per_beam_s = 0.001;
    measure_at(scan, square_room(3.0), {});

    const auto all_finite = [&points] {
        for (std::uint32_t i = 0; i < points->count; ++i) {
            if (!std::isfinite(points->x_m[i]) || !std::isfinite(points->y_m[i]) || !(points->range_m[i] > 0.0F)) {
                return false;
            }
        }
        return true;
    };
    SECTION("a hit without a number is no hit") {
        scan.range_m[3] = kNan;
        scan.range_m[7] = kInfinity;
        scan.range_m[9] = -1.0F;
        scan.range_m[11] = 3e38F;
        projector.project(scan, odometry, *points);
        CHECK(points->count == 60);
        CHECK(all_finite());
    }
    SECTION("no beams at all") {
        scan.count = 0;
        projector.project(scan, odometry, *points);
        CHECK(points->count == 0);
        CHECK(points->beams == 0);
    }
    SECTION("more beams than a scan can hold") {
        scan.count = std::numeric_limits<std::uint32_t>::max();
        projector.project(scan, odometry, *points);
        CHECK(points->beams == capacity::kBeams);
        CHECK(points->count == 64);
        CHECK(all_finite());
    }
    SECTION("a time per beam that is none means no de-skew") {
        scan.time_per_beam_s =
            GENERATE(std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity(), -1e300);
        projector.project(scan, odometry, *points);
        CHECK(points->count == 64);
        CHECK(all_finite());
        CHECK(points->P_base_last_lidar == points->P_base_first_lidar);
    }
}
