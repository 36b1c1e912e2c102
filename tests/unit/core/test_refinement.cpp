#include <catch2/catch.hpp>
#include <cmath>
#include <memory>

#include "core/slam/map_update.hpp"
#include "core/slam/refinement.hpp"
#include "core/slam/scan_points.hpp"
#include "tests/unit/core/synthetic.hpp"

using namespace crspf;
using namespace crspf::test;

namespace {

constexpr double kResolution_m = 0.05;
constexpr double kDegenerateBelow = 0.1;
/// An odometer of which nobody expects much: the match decides.
constexpr MotionPrior kLoose{.P_from_to = {}, .translation_stddev_m = 0.5, .rotation_stddev_rad = 0.2};

/// A map drawn from noisy scans around the origin, and a clean scan taken at the origin.
class Place {
 public:
    explicit Place(const Walls& walls)
        : field_(make_large<MatchField>()), objective_(std::make_unique<MatchObjective>(params(), Kernel::kFastest)) {
        auto update = make_large<MapUpdate>(params().map, 0.01);
        auto changes = std::make_unique<ChangeList>();
        auto points = std::make_unique<ScanPoints>();
        ScanProjector projector({}, false);
        Scan scan = beams_of(720, radians(-179.75), radians(179.75));
        Rng rng(80);
        for (int i = 0; i < 30; ++i) {
            const Pose2 P{
                .x_m = 0.3 * rng.symmetric(), .y_m = 0.3 * rng.symmetric(), .theta_rad = 0.3 * rng.symmetric()};
            measure_at(scan, walls, P);
            for (std::uint32_t k = 0; k < scan.count; ++k) {
                scan.range_m[k] += static_cast<float>(0.03 * rng.symmetric());
            }
            projector.project(scan, Odometry({}), *points);
            changes->clear();
            update->draw(*points, P, false, *changes);
            field_->follow(changes->view());
        }
        measure_at(scan, walls, {});
        projector.project(scan, Odometry({}), *points);
        SurfaceNormals normals(0.01);
        normals.measure(*points);
        objective_->load(*points, {}, normals);
    }
    const MatchObjective& aimed_at(const Pose2& observed, const MotionPrior& prior = kLoose) {
        REQUIRE(objective_->aim(*field_, observed, prior));
        return *objective_;
    }

 private:
    static SlamParams params() {
        SlamParams p;
        p.map.resolution_m = kResolution_m;
        return p;
    }

    std::unique_ptr<MatchField> field_;
    std::unique_ptr<MatchObjective> objective_;
};

Walls room() {
    Walls walls;
    add_box(walls, -2.975, -2.475, 3.025, 2.525);
    return walls;
}

/// Two endless walls along `heading_rad`.
Walls corridor(double heading_rad) {
    const SinCos r = sin_cos(heading_rad);
    Walls walls;
    for (const double side : {-1.0, 1.0}) {
        walls.push_back({-30.0 * r.cos - side * r.sin, -30.0 * r.sin + side * r.cos, 30.0 * r.cos - side * r.sin,
                         30.0 * r.sin + side * r.cos});
    }
    return walls;
}

MatchShape shape_at(const MatchObjective& objective, const Pose2& P, double degenerate_below) {
    return match_shape(objective, P, kResolution_m, degenerate_below);
}
double penalised(const MatchObjective& objective, const Pose2& P) {
    return objective.linearize(P).match - objective.pull(P);
}

}  // namespace

TEST_CASE("the refinement finds the pose to a fraction of a cell and never makes the match worse") {
    Place place(room());
    Rng rng(81);
    double worst_m = 0.0;
    double worst_rad = 0.0;
    double mean_start_m = 0.0;
    double mean_m = 0.0;
    constexpr int kRounds = 100;
    for (int i = 0; i < kRounds; ++i) {
        const Pose2 start{
            .x_m = 0.04 * rng.symmetric(), .y_m = 0.04 * rng.symmetric(), .theta_rad = 0.01 * rng.symmetric()};
        const MatchObjective& objective = place.aimed_at(start);
        const Refined refined = refine(objective, start);
        REQUIRE(refined.evaluations >= 1);
        REQUIRE(refined.evaluations <= 10);
        REQUIRE(penalised(objective, refined.P_map_base) >= penalised(objective, start));
        worst_m = std::max(worst_m, std::hypot(refined.P_map_base.x_m, refined.P_map_base.y_m));
        mean_m += std::hypot(refined.P_map_base.x_m, refined.P_map_base.y_m) / kRounds;
        worst_rad = std::max(worst_rad, std::abs(refined.P_map_base.theta_rad));
        mean_start_m += std::hypot(start.x_m, start.y_m) / kRounds;
    }
    CHECK(worst_m < 0.4 * kResolution_m);
    CHECK(worst_rad < 0.6 * kResolution_m / 3.0);  // of a cell, at walls 3 m away
    CHECK(mean_m < 0.2 * kResolution_m);
    CHECK(mean_start_m > 0.5 * kResolution_m);  // there was something to find
}

TEST_CASE("on an empty map the refinement stays where it is") {
    Place place({{100.0, -1.0, 100.0, 1.0}, {2.0, -1.0, 2.0, 1.0}});
    const Pose2 far{.x_m = -20.0, .y_m = 5.0, .theta_rad = 0.4};
    const Refined refined = refine(place.aimed_at(far), far);
    CHECK(std::hypot(refined.P_map_base.x_m - far.x_m, refined.P_map_base.y_m - far.y_m) < 1e-6);
    CHECK(refined.P_map_base.theta_rad == Approx(far.theta_rad));
}

TEST_CASE("a trusted odometer holds the refinement back") {
    Place place(room());
    const Pose2 start{.x_m = 0.03, .y_m = -0.03, .theta_rad = 0.0};
    const auto left_over = [&](double stddev_m) {
        const MotionPrior prior{.P_from_to = {}, .translation_stddev_m = stddev_m, .rotation_stddev_rad = 0.2};
        const Pose2 found = refine(place.aimed_at(start, prior), start).P_map_base;
        return std::hypot(found.x_m, found.y_m);
    };
    CHECK(left_over(0.0005) > 0.02);
    CHECK(left_over(0.5) < 0.02);
}

TEST_CASE("a room is seen in every direction") {
    Place place(room());
    const MatchShape shape = shape_at(place.aimed_at({}), {}, kDegenerateBelow);
    CHECK_FALSE(shape.degenerate);
    CHECK(shape.weakest_ratio > 0.3);
    CHECK(shape.weakest_ratio <= 1.0);
    const Covariance3& c = shape.covariance;
    // Positive definite, and better than the odometry alone.
    CHECK(c.xx > 0.0);
    CHECK(c.xx * c.yy - c.xy * c.xy > 0.0);
    CHECK(c.xx * (c.yy * c.tt - c.yt * c.yt) - c.xy * (c.xy * c.tt - c.yt * c.xt) + c.xt * (c.xy * c.yt - c.yy * c.xt) >
          0.0);
    CHECK(c.xx < 0.1 * kLoose.translation_stddev_m * kLoose.translation_stddev_m);
    CHECK(c.yy < 0.1 * kLoose.translation_stddev_m * kLoose.translation_stddev_m);
    CHECK(c.tt < 0.1 * kLoose.rotation_stddev_rad * kLoose.rotation_stddev_rad);
}

TEST_CASE("along a corridor nothing is seen: the odometry's word is kept there, and only there") {
    const double heading = GENERATE(0.0, 0.5, kPi / 2.0, 2.5);
    CAPTURE(heading);
    Place place(corridor(heading));
    const MatchShape shape = shape_at(place.aimed_at({}), {}, kDegenerateBelow);
    CHECK(shape.degenerate);
    CHECK(std::hypot(shape.weakest_x, shape.weakest_y) == Approx(1.0));
    CHECK(std::abs(shape.weakest_x * std::cos(heading) + shape.weakest_y * std::sin(heading)) > 0.99);
    // The doubt along the corridor stays the odometry's; across it is far smaller.
    const Covariance3& c = shape.covariance;
    const double s = std::sin(heading);
    const double k = std::cos(heading);
    const double along = k * k * c.xx + 2.0 * k * s * c.xy + s * s * c.yy;
    const double across = s * s * c.xx - 2.0 * k * s * c.xy + k * k * c.yy;
    CHECK(across < 0.1 * along);
    CHECK(along < 1.01 * kLoose.translation_stddev_m * kLoose.translation_stddev_m);

    CHECK_FALSE(shape_at(place.aimed_at({}), {}, 0.0).degenerate);  // switched off by its bound
}

TEST_CASE("keeping the odometry along a direction is a projection") {
    MatchShape shape;
    shape.weakest_x = 0.6;
    shape.weakest_y = 0.8;
    const Pose2 observed{.x_m = 1.0, .y_m = 2.0, .theta_rad = 0.1};
    const Pose2 found{.x_m = 1.0 + 0.3 * 0.6 - 0.2 * 0.8, .y_m = 2.0 + 0.3 * 0.8 + 0.2 * 0.6, .theta_rad = 0.4};
    const Pose2 kept = keep_odometry_along(shape, found, observed);
    CHECK(kept.x_m == Approx(1.0 - 0.2 * 0.8));  // the 0.3 along is gone, the 0.2 across stays
    CHECK(kept.y_m == Approx(2.0 + 0.2 * 0.6));
    CHECK(kept.theta_rad == 0.4);
    CHECK(keep_odometry_along(shape, observed, observed) == observed);
}

TEST_CASE("where nothing matches the covariance is the odometry's") {
    Place place({{2.0, -1.0, 2.0, 1.0}});
    const Pose2 far{.x_m = -20.0, .y_m = 5.0, .theta_rad = 0.0};
    const MatchShape shape = shape_at(place.aimed_at(far), far, kDegenerateBelow);
    CHECK_FALSE(shape.degenerate);  // no ridge to be flat along
    CHECK(shape.covariance.xx == Approx(kLoose.translation_stddev_m * kLoose.translation_stddev_m));
    CHECK(shape.covariance.yy == Approx(kLoose.translation_stddev_m * kLoose.translation_stddev_m));
    CHECK(shape.covariance.tt == Approx(kLoose.rotation_stddev_rad * kLoose.rotation_stddev_rad));
}
