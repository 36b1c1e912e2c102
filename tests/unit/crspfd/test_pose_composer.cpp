#include <catch2/catch.hpp>
#include <cmath>

#include "platform/crspfd/pose_composer.hpp"

using namespace crspf;

namespace {

constexpr Stamp kNow{5'000'000'000};
constexpr Duration kPeriod{20'000'000};

OdometryState odometry_at(Stamp stamp) {
    OdometryState odometry;
    odometry.stamp = stamp;
    odometry.P_odom_base = {.x_m = 1.0, .y_m = 2.0, .theta_rad = 0.5};
    odometry.speed_mps = 1.0;
    odometry.yaw_rate_radps = 0.2;
    return odometry;
}

FilterState filter_at(Stamp stamp) {
    FilterState filter;
    filter.result.stamp = stamp;
    filter.result.matched = true;
    filter.result.result = true;
    filter.result.M = 1200.0;
    return filter;
}

}  // namespace

TEST_CASE("composer: the pose is of the moment it is sent") {
    PoseComposer composer{PoseOutputConfig{}};
    const PoseReport report =
        composer.compose(kNow, odometry_at(kNow - Duration{50'000'000}), filter_at(kNow - Duration{80'000'000}));
    CHECK(report.P_map_base.x_m == Approx(1.0 + 0.05 * std::cos(0.5)));
    CHECK(report.P_map_base.y_m == Approx(2.0 + 0.05 * std::sin(0.5)));
    CHECK(report.P_map_base.theta_rad == Approx(0.51));
    CHECK(report.age == Duration{80'000'000});
    CHECK(report.M == 1200.0);
    CHECK(report.matched);
    CHECK(report.result);
    CHECK_FALSE(report.lost);
    CHECK(report.resets == 0);
}

TEST_CASE("composer: before the first scan the pose is lost and has no age") {
    PoseComposer composer{PoseOutputConfig{}};
    const PoseReport report = composer.compose(kNow, odometry_at(kNow), FilterState{});
    CHECK(report.age == kNoScanYet);
    CHECK(report.lost);
}

TEST_CASE("composer: a correction is let in at the configured speed") {
    const PoseOutputConfig config;
    PoseComposer composer{config};
    OdometryState odometry = odometry_at(kNow);
    odometry.speed_mps = odometry.yaw_rate_radps = 0.0;
    static_cast<void>(composer.compose(kNow, odometry, filter_at(kNow)));
    odometry.P_map_odom = {.x_m = 0.3, .y_m = 0.0, .theta_rad = 0.0};
    double before_m = 1.0;
    int steps = 0;
    for (Stamp now = kNow + kPeriod; before_m < 1.3 - 1e-9; now = now + kPeriod) {
        odometry.stamp = now;
        const PoseReport report = composer.compose(now, odometry, filter_at(now));
        const double step_m = report.P_map_base.x_m - before_m;
        REQUIRE(step_m > 0.0);
        REQUIRE(step_m <= config.correction_mps * kPeriod.seconds() + 1e-9);
        REQUIRE(report.resets == 0);
        before_m = report.P_map_base.x_m;
        REQUIRE(++steps < 100);
    }
    CHECK(steps == 30);
    CHECK(composer.counters().jumps == 0);
}

TEST_CASE("composer: a little turn of the map's frame does not throw a robot that is far from its origin") {
    const PoseOutputConfig config;
    PoseComposer composer{config};
    OdometryState odometry = odometry_at(kNow);
    odometry.P_odom_base = {.x_m = 30.0, .y_m = 0.0, .theta_rad = 0.0};
    odometry.speed_mps = odometry.yaw_rate_radps = 0.0;
    const PoseReport before = composer.compose(kNow, odometry, filter_at(kNow));
    odometry.P_map_odom = {.x_m = 0.0, .y_m = 0.0, .theta_rad = 0.01};  // 0.3 m at the robot
    odometry.stamp = kNow + kPeriod;
    const PoseReport after = composer.compose(kNow + kPeriod, odometry, filter_at(kNow + kPeriod));
    const double moved_m =
        std::hypot(after.P_map_base.x_m - before.P_map_base.x_m, after.P_map_base.y_m - before.P_map_base.y_m);
    CHECK(moved_m > 0.0);
    CHECK(moved_m <= config.correction_mps * kPeriod.seconds() + 1e-9);
}

TEST_CASE("composer: what is too large to be let in, or was placed, is a jump that is announced") {
    PoseComposer composer{PoseOutputConfig{}};
    OdometryState odometry = odometry_at(kNow);
    static_cast<void>(composer.compose(kNow, odometry, filter_at(kNow)));
    odometry.P_map_odom = {.x_m = 3.0, .y_m = 0.0, .theta_rad = 0.0};
    const PoseReport far = composer.compose(kNow, odometry, filter_at(kNow));
    CHECK(far.P_map_base.x_m == Approx(4.0));
    CHECK(far.resets == 1);
    odometry.P_map_odom = {.x_m = 3.1, .y_m = 0.0, .theta_rad = 0.0};
    ++odometry.jumps;
    const PoseReport placed = composer.compose(kNow, odometry, filter_at(kNow));
    CHECK(placed.P_map_base.x_m == Approx(4.1));
    CHECK(placed.resets == 2);
    CHECK(composer.counters().jumps == 2);
}

TEST_CASE("composer: what is stale is lost, not extrapolated") {
    const PoseOutputConfig config;
    PoseComposer composer{config};
    SECTION("nothing has come yet") {
        CHECK(composer.compose(kNow, {}, {}).lost);
    }
    SECTION("the odometer is silent") {
        const OdometryState odometry = odometry_at(kNow);
        const Stamp later = kNow + Duration::from_seconds(config.odometry_stale_s) + kPeriod;
        const PoseReport report = composer.compose(later, odometry, filter_at(later));
        CHECK(report.lost);
        CHECK(report.speed_mps == 0.0);
        const PoseReport much_later = composer.compose(later + Duration{9'000'000'000}, odometry, filter_at(later));
        CHECK(much_later.P_map_base == report.P_map_base);  // it does not drive on
    }
    SECTION("the lidar is silent") {
        const Stamp later = kNow + Duration::from_seconds(config.match_stale_s) + kPeriod;
        const PoseReport report = composer.compose(later, odometry_at(later), filter_at(kNow));
        CHECK(report.lost);
        CHECK_FALSE(report.matched);
        CHECK_FALSE(report.result);
    }
    SECTION("the odometer has been blind for as long") {
        OdometryState odometry = odometry_at(kNow);
        odometry.blind_since = kNow - Duration::from_seconds(config.odometry_stale_s);
        const Stamp later = kNow + kPeriod;
        odometry.stamp = later;
        FilterState filter = filter_at(later);
        CHECK_FALSE(composer.compose(later, odometry, filter).lost);  // the scans show the motion
        filter.result.shape.degenerate = true;
        CHECK(composer.compose(later, odometry, filter).lost);
        filter.result.shape.degenerate = false;
        filter.result.result = false;
        CHECK(composer.compose(later, odometry, filter).lost);
        odometry.blind_since = {};
        CHECK_FALSE(composer.compose(later, odometry, filter).lost);
        filter.result.result = true;
        filter.result.shape.degenerate = true;
        CHECK_FALSE(composer.compose(later, odometry, filter).lost);
        odometry.blind_since = kNow - Duration::from_seconds(config.odometry_stale_s);
        CHECK(composer.compose(later, odometry, filter).lost);
    }
    SECTION("the filter is lost") {
        FilterState filter = filter_at(kNow);
        filter.result.lost = true;
        CHECK(composer.compose(kNow, odometry_at(kNow), filter).lost);
    }
    CHECK(composer.counters().lost > 0);
}
