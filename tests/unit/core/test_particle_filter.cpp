#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <limits>
#include <memory>

#include "core/slam/particle_filter.hpp"
#include "tests/unit/core/synthetic.hpp"

using namespace crspf;
using namespace crspf::test;

namespace {

constexpr double kResolution_m = 0.05;
constexpr Pose2 kTruth{.x_m = 0.4, .y_m = -0.3, .theta_rad = 0.2};
constexpr MotionPrior kPrior{.P_from_to = {}, .translation_stddev_m = 0.05, .rotation_stddev_rad = 0.03};

SlamParams room_params() {
    SlamParams p;
    p.map.resolution_m = kResolution_m;
    return p;
}

/// A room with its map drawn, and a scan of it taken at kTruth.
class Room {
 public:
    explicit Room(const SlamParams& params = room_params())
        : world_(make_large<MapAndField>()), objective_(std::make_unique<MatchObjective>(params, Kernel::kFastest)) {
        Walls walls = square_room(3.0);
        add_box(walls, 1.5, 1.0, 2.0, 2.2);
        for (const Wall& wall : walls) {
            world_->draw(wall, kResolution_m);
        }
        Scan scan = beams_of(360, radians(-179.5), radians(179.5));
        measure_at(scan, walls, kTruth);
        auto points = std::make_unique<ScanPoints>();
        ScanProjector({}, false).project(scan, Odometry({}), *points);
        objective_->load(*points, {}, SurfaceNormals(0.01));
    }
    const MatchObjective& aimed_at(const Pose2& observed, const MotionPrior& prior = kPrior) {
        REQUIRE(objective_->aim(world_->field(), observed, prior));
        return *objective_;
    }

 private:
    std::unique_ptr<MapAndField> world_;
    std::unique_ptr<MatchObjective> objective_;
};

constexpr Pose2 kObserved{.x_m = 0.48, .y_m = -0.37, .theta_rad = 0.23};

}  // namespace

TEST_CASE("(9) goes through its end points, falls between them, and is held outside") {
    Rng rng(71);
    for (int round = 0; round < 5000; ++round) {
        const double match_min = uniform(rng, 0.0, 1500.0);
        const double match_max = match_min + uniform(rng, 1.0, 1500.0);
        const double at_best = uniform(rng, 0.001, 100.0);
        const double at_worst = at_best + uniform(rng, 0.001, 300.0);
        const auto f = [&](double m) { return feedback(m, match_min, match_max, at_best, at_worst); };
        CAPTURE(match_min, match_max, at_best, at_worst);
        REQUIRE(f(match_min) == Approx(at_worst).epsilon(1e-9));
        REQUIRE(f(match_max) == Approx(at_best).epsilon(1e-9));
        double before = f(match_min);
        for (int i = 1; i <= 20; ++i) {
            const double u = i / 20.0;
            const double m = match_min + u * (match_max - match_min);
            const double value = f(m);
            REQUIRE(value < before);
            // An inverse proportion: its reciprocal is a straight line.
            REQUIRE(1.0 / value == Approx((1.0 - u) / at_worst + u / at_best).epsilon(1e-9));
            before = value;
        }
        REQUIRE(f(match_min - uniform(rng, 0.0, 1e6)) == f(match_min));
        REQUIRE(f(match_max + uniform(rng, 0.0, 1e6)) == f(match_max));
        REQUIRE(f(-std::numeric_limits<double>::infinity()) == f(match_min));
        REQUIRE(f(std::numeric_limits<double>::infinity()) == f(match_max));
        REQUIRE(feedback(uniform(rng, 0.0, 3000.0), match_min, match_max, at_best, at_best) == Approx(at_best));
    }
}

TEST_CASE("(9) in numbers") {
    // Half way, the inverse proportion gives the harmonic mean.
    CHECK(feedback(850.0, 500.0, 1200.0, 20.0, 300.0) == Approx(2.0 / (1.0 / 20.0 + 1.0 / 300.0)));
}

TEST_CASE("the search finds the pose and never does worse than P~") {
    Room room;
    SlamParams params = room_params();
    for (std::uint64_t seed = 1; seed <= 10; ++seed) {
        params.particle_filter.seed = seed;
        ParticleFilter filter(params.particle_filter, kResolution_m);
        const MatchObjective& objective = room.aimed_at(kObserved);
        const Particle best = filter.search(objective, 0.0);
        CAPTURE(seed);
        CHECK(best.score == objective.score(best.P_map_base));
        CHECK(best.score > objective.score(kObserved));
        CHECK(std::hypot(best.P_map_base.x_m - kTruth.x_m, best.P_map_base.y_m - kTruth.y_m) < 1.5 * kResolution_m);
        CHECK(turn_between(best.P_map_base.theta_rad, kTruth.theta_rad) < 0.02);
    }
}

TEST_CASE("where nothing matches the observed pose stands") {
    SlamParams params = room_params();
    auto empty = make_large<MapAndField>();
    MatchObjective objective(params, Kernel::kFastest);
    auto points = std::make_unique<ScanPoints>();
    points->count = 1;
    points->x_m[0] = 1.0F;
    points->y_m[0] = 1.0F;
    objective.load(*points, {}, SurfaceNormals(0.01));
    REQUIRE(objective.aim(empty->field(), kObserved, kPrior));
    const Particle best = ParticleFilter(params.particle_filter, kResolution_m).search(objective, 0.0);
    CHECK(best.P_map_base == kObserved);
    CHECK(best.score == 0.0);
}

TEST_CASE("the number of evaluations follows M(t-1) and has a hard bound") {
    Room room;
    ParticleFilterParams p = room_params().particle_filter;
    // So sure an odometer that (9) alone decides.
    constexpr MotionPrior kSure{.P_from_to = {}, .translation_stddev_m = 0.002, .rotation_stddev_rad = 0.001};
    const auto evaluations = [&](double M, std::uint64_t seed) {
        p.seed = seed;
        return ParticleFilter(p, kResolution_m).search(room.aimed_at(kObserved, kSure), M).evaluations;
    };
    const auto sum = [&](double M) {
        std::uint32_t total = 0;
        for (std::uint64_t seed = 1; seed <= 20; ++seed) {
            total += evaluations(M, seed);
        }
        return total;
    };
    p.evaluations_max = 20000;
    const std::uint32_t lost = sum(0.0);
    const std::uint32_t fair = sum(0.5 * (p.match_min + p.match_max));
    const std::uint32_t good = sum(kMatchMax);
    CHECK(good < fair);
    CHECK(fair < lost);
    CHECK(good >= 20 * p.particles_min);

    SECTION("without the feedback of (9) it is always the largest") {
        p.feedback = false;
        CHECK(sum(kMatchMax) == lost);
    }
    SECTION("the bound holds, down to the one evaluation of P~") {
        for (const std::uint32_t bound : {1U, 2U, 10U, 100U}) {
            p.evaluations_max = bound;
            CHECK(evaluations(0.0, 1) == bound);
        }
    }
}

TEST_CASE("a seed decides the particles") {
    Room room;
    ParticleFilterParams p = room_params().particle_filter;
    const auto twice = [&](std::uint64_t seed) {
        p.seed = seed;
        ParticleFilter filter(p, kResolution_m);
        const Particle first = filter.search(room.aimed_at(kObserved), 0.0);
        const Particle second = filter.search(room.aimed_at(kObserved), 0.0);
        return std::pair{first.P_map_base, second.P_map_base};
    };
    CHECK(twice(5) == twice(5));
    CHECK_FALSE(twice(5) == twice(6));
    CHECK_FALSE(twice(5).first == twice(5).second);  // the generator goes on
}

TEST_CASE("the search is as wide as the odometry is unsure") {
    // The range by (9) alone does not reach the truth; three standard deviations do.
    Room room;
    ParticleFilterParams p = room_params().particle_filter;
    p.range_min_m = p.range_max_m = 0.02;
    p.angle_min_rad = p.angle_max_rad = 0.01;
    p.range_stddevs = 3.0;
    p.evaluations_max = 20000;
    constexpr Pose2 kFar{.x_m = 0.1, .y_m = -0.6, .theta_rad = 0.35};
    const auto error = [&](const MotionPrior& prior) {
        const Particle best = ParticleFilter(p, kResolution_m).search(room.aimed_at(kFar, prior), 0.0);
        return std::hypot(best.P_map_base.x_m - kTruth.x_m, best.P_map_base.y_m - kTruth.y_m);
    };
    CHECK(error({.P_from_to = {}, .translation_stddev_m = 0.3, .rotation_stddev_rad = 0.1}) < 2.0 * kResolution_m);
    CHECK(error({.P_from_to = {}, .translation_stddev_m = 0.001, .rotation_stddev_rad = 0.001}) > 0.2);
}

TEST_CASE("however unsure the odometry is, every look-up stays in the field's window") {
    // Land past the window that matches perfectly: who finds it has looked where the view is not valid.
    const SlamParams params = room_params();
    auto world = make_large<MapAndField>();
    constexpr std::int32_t kWindow = FieldView::kTiles / 2 * TileGeometry::kSide;
    for (std::int32_t y = -500; y < 500; ++y) {
        for (std::int32_t x = kWindow + 100; x < kWindow + 1100; ++x) {
            world->set({.x = x, .y = y}, kOccupiedCell);
        }
    }
    MatchObjective objective(params, Kernel::kFastest);
    auto points = std::make_unique<ScanPoints>();
    points->count = 1;
    points->x_m[0] = 1.0F;
    points->y_m[0] = 0.0F;
    objective.load(*points, {}, SurfaceNormals(0.01));
    const double told_m = GENERATE(0.0, 100.0);
    const MotionPrior lost{
        .P_from_to = {}, .translation_stddev_m = 100.0, .rotation_stddev_rad = 1.0, .told_stddev_m = told_m};
    REQUIRE(objective.aim(world->field(), {}, lost));
    for (std::uint64_t seed = 1; seed <= 5; ++seed) {
        ParticleFilterParams p = params.particle_filter;
        p.seed = seed;
        p.evaluations_max = 20000;
        const Particle best = ParticleFilter(p, kResolution_m).search(objective, 0.0);
        CHECK(std::abs(best.P_map_base.x_m) + 1.0 < kWindow * kResolution_m);
    }
}
