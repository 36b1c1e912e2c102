#include <array>
#include <catch2/catch.hpp>
#include <cmath>
#include <functional>
#include <limits>
#include <memory>
#include <vector>

#include "core/slam/direct_match.hpp"
#include "core/slam/match_objective.hpp"
#include "tests/unit/core/synthetic.hpp"

using namespace crspf;
using namespace crspf::test;

namespace {

constexpr double kResolution_m = 0.05;
constexpr double kCellsPerMetre = 1.0 / kResolution_m;
constexpr MotionPrior kPrior{.P_from_to = {}, .translation_stddev_m = 0.05, .rotation_stddev_rad = 0.02};

SlamParams params() {
    SlamParams p;
    p.map.resolution_m = kResolution_m;
    p.critical_rays.weight = 4.0;
    return p;
}

/// An objective with its rays, some of them critical.
struct Rays {
    std::unique_ptr<ScanPoints> points = std::make_unique<ScanPoints>();
    std::array<bool, capacity::kBeams> critical{};
    SurfaceNormals normals{0.01};
    std::unique_ptr<MatchObjective> objective;

    explicit Rays(const SlamParams& p = params(), Kernel kernel = Kernel::kFastest)
        : objective(std::make_unique<MatchObjective>(p, kernel)) {
        points->count = 0;
    }
    void add(double x_m, double y_m, bool is_critical = false) {
        points->x_m[points->count] = static_cast<float>(x_m);
        points->y_m[points->count] = static_cast<float>(y_m);
        critical[points->count] = is_critical;
        ++points->count;
    }
    void load() const { objective->load(*points, critical, normals); }
};

double slope(const std::function<double(double)>& f, double h) {
    return (f(h) - f(-h)) / (2.0 * h);
}

}  // namespace

TEST_CASE("the objective's match is (10) evaluated directly, bit for bit") {
    auto world = make_large<MapAndField>();
    Rng rng(61);
    for (int i = 0; i < 30000; ++i) {
        world->set({.x = whole(rng, -150, 150), .y = whole(rng, -150, 150)}, static_cast<Evidence>(whole(rng, 1, 255)));
    }
    const Kernel kernel = GENERATE(Kernel::kFastest, Kernel::kPortable);
    for (int round = 0; round < 50; ++round) {
        Rays rays(params(), kernel);
        std::array<std::vector<float>, 4> split;  // critical x and y, ordinary x and y. [cells]
        for (std::int32_t n = whole(rng, 1, 100); n > 0; --n) {
            const bool is_critical = rng.next() % 7 == 0;
            rays.add(uniform(rng, -5.0, 5.0), uniform(rng, -5.0, 5.0), is_critical);
            const std::uint32_t i = rays.points->count - 1;
            split[is_critical ? 0 : 2].push_back(rays.points->x_m[i] * static_cast<float>(kCellsPerMetre));
            split[is_critical ? 1 : 3].push_back(rays.points->y_m[i] * static_cast<float>(kCellsPerMetre));
        }
        rays.load();
        const FieldPoints critical{
            .x = split[0].data(), .y = split[1].data(), .count = rays.objective->critical_rays()};
        const FieldPoints ordinary{.x = split[2].data(),
                                   .y = split[3].data(),
                                   .count = rays.objective->rays() - rays.objective->critical_rays()};
        REQUIRE(critical.count == split[0].size());
        REQUIRE(ordinary.count == split[2].size());
        for (int k = 0; k < 20; ++k) {
            const Pose2 P{
                .x_m = 3.0 * rng.symmetric(), .y_m = 3.0 * rng.symmetric(), .theta_rad = uniform(rng, -kPi, kPi)};
            REQUIRE(rays.objective->aim(world->field(), P, kPrior));
            const double m = rays.objective->match(P);
            REQUIRE(m == direct_match(world->map(), critical, ordinary, 4.0, P, kCellsPerMetre));
            REQUIRE(rays.objective->score(P) == m / kMatchMax);  // no pull at P~ itself
        }
    }
}

TEST_CASE("a critical ray weighs a_i, on either side of the balance") {
    auto world = make_large<MapAndField>();
    world->set({.x = 20, .y = 0}, kOccupiedCell);
    Rays rays;
    const bool hit_is_critical = GENERATE(false, true);
    rays.add(1.01, 0.01, hit_is_critical);
    rays.add(0.01, 1.01, !hit_is_critical);
    rays.load();
    REQUIRE(rays.objective->aim(world->field(), {}, kPrior));
    CHECK(rays.objective->match({}) == Approx(255.0 * (hit_is_critical ? 4.0 : 1.0) / 5.0));
}

TEST_CASE("rays into unseen land say nothing to match_seen") {
    auto world = make_large<MapAndField>();
    world->set({.x = 20, .y = 0}, kOccupiedCell);
    world->set({.x = 0, .y = -20}, kFreeCell);
    Rays rays;
    rays.add(1.01, 0.01);   // the wall
    rays.add(0.01, -0.99);  // seen free: counts against
    rays.add(0.01, 1.01);   // unseen
    rays.add(0.01, 1.31);   // unseen
    rays.load();
    REQUIRE(rays.objective->aim(world->field(), {}, kPrior));
    CHECK(rays.objective->match({}) == Approx(255.0 / 4.0));
    CHECK(rays.objective->match_seen({}) == Approx(255.0 / 2.0));
    SECTION("too few of them give no verdict") {
        for (int i = 0; i < 20; ++i) {
            rays.add(-1.0, 0.1 * i);
        }
        rays.load();
        REQUIRE(rays.objective->aim(world->field(), {}, kPrior));
        CHECK(rays.objective->match_seen({}) < 0.0);
        CHECK(rays.objective->match({}) > 0.0);
    }
}

TEST_CASE("rays past the field's reach are left out") {
    const double reach_m = MatchField::kReach * kResolution_m;
    Rays rays;
    rays.add(reach_m - 0.01, 0.0);
    rays.add(reach_m + 0.01, 0.0);
    rays.add(0.8 * reach_m, -0.8 * reach_m, true);
    rays.add(1e30, 1e30);
    rays.add(1.0, 1.0, true);
    rays.load();
    CHECK(rays.objective->rays() == 2);
    CHECK(rays.objective->critical_rays() == 1);
}

TEST_CASE("outside the map's extent there is nothing to aim at") {
    auto world = make_large<MapAndField>();
    Rays rays;
    rays.add(1.0, 1.0);
    rays.load();
    const double edge_m = TileGeometry::kHalf * kResolution_m;
    const double nan = std::numeric_limits<double>::quiet_NaN();
    CHECK(rays.objective->aim(world->field(), {.x_m = 0.5 * edge_m, .y_m = -0.5 * edge_m}, kPrior));
    for (const double x_m : {edge_m, -edge_m, 0.99 * edge_m, 1e300, -1e300, nan}) {
        CHECK_FALSE(rays.objective->aim(world->field(), {.x_m = x_m}, kPrior));
        CHECK_FALSE(rays.objective->aim(world->field(), {.y_m = x_m}, kPrior));
    }
}

TEST_CASE("the pull grows with the distance from P~, saturates, and leaves a heading alone that is not trusted") {
    auto world = make_large<MapAndField>();
    SlamParams p = params();
    p.particle_filter.pull_weight = 0.01;
    p.particle_filter.pull_saturation = 50.0;
    Rays rays(p);
    rays.add(1.0, 1.0);
    rays.load();
    const Pose2 observed{.x_m = 2.0, .y_m = -1.0, .theta_rad = 0.3};
    REQUIRE(rays.objective->aim(world->field(), observed, kPrior));
    const auto at = [&](double dx, double dy, double turn = 0.0) {
        return Pose2{.x_m = observed.x_m + dx, .y_m = observed.y_m + dy, .theta_rad = observed.theta_rad + turn};
    };
    const MatchObjective& objective = *rays.objective;
    CHECK(objective.pull(observed) == 0.0);
    CHECK(objective.pull(at(0.0, 0.0, 1.0)) == 0.0);
    double before = 0.0;
    for (int i = 1; i < 200; ++i) {
        const double d = 0.01 * i;
        const double pull = objective.pull(at(d, 0.0));
        const double squared = std::pow(d / kPrior.translation_stddev_m, 2);
        REQUIRE(pull > before);
        REQUIRE(pull == Approx(0.01 * squared / (1.0 + squared / 50.0)));
        REQUIRE(objective.pull(at(0.0, -d)) == Approx(pull));
        REQUIRE(objective.pull(at(0.6 * d, 0.8 * d)) == Approx(pull));
        before = pull;
    }
    CHECK(objective.pull(at(1000.0, 0.0)) < 0.01 * 50.0);

    SECTION("the heading counts as far as it is trusted, like the position") {
        REQUIRE(rays.objective->aim(world->field(), observed, kPrior, 0.25));
        const double turn_rad = 2.0 * kPrior.rotation_stddev_rad;
        CHECK(objective.pull(at(0.0, 0.0, turn_rad)) == Approx(0.01 * 1.0 / (1.0 + 1.0 / 50.0)));
        CHECK(objective.pull(at(0.0, 0.0, turn_rad - 2.0 * kPi)) == Approx(objective.pull(at(0.0, 0.0, -turn_rad))));
        CHECK(objective.pull(at(kPrior.translation_stddev_m, 0.0, turn_rad)) ==
              Approx(0.01 * 2.0 / (1.0 + 2.0 / 50.0)));
    }

    SECTION("its curvature times the offset is half its slope") {
        for (const double d : {0.0, 0.02, 0.1, 0.5}) {
            const double slope_m = slope([&](double h) { return objective.pull(at(d + h, 0.0)); }, 1e-6);
            CHECK(objective.pull_curvature(at(d, 0.0)) * d == Approx(0.5 * slope_m).margin(1e-7));
        }
    }
}

TEST_CASE("the linearized match has the slopes of the interpolated field") {
    auto world = make_large<MapAndField>();
    Rng rng(62);
    for (int i = 0; i < 4000; ++i) {
        world->set({.x = whole(rng, -60, 60), .y = whole(rng, -60, 60)}, static_cast<Evidence>(whole(rng, 1, 255)));
    }
    int checked = 0;
    for (int round = 0; round < 500; ++round) {
        Rays rays;
        rays.add(2.0 * rng.symmetric(), 2.0 * rng.symmetric(), round % 2 == 0);
        rays.load();
        const Pose2 P{.x_m = 0.5 * rng.symmetric(), .y_m = 0.5 * rng.symmetric(), .theta_rad = uniform(rng, -3.0, 3.0)};
        REQUIRE(rays.objective->aim(world->field(), P, kPrior));
        constexpr double kStep = 2e-3;  // places are exact to 2^-10 of a cell: 0.05 mm
        const auto f = [&](double dx, double dy, double dt) {
            return rays.objective->linearize({.x_m = P.x_m + dx, .y_m = P.y_m + dy, .theta_rad = P.theta_rad + dt})
                .match;
        };
        const double here = f(0, 0, 0);
        const std::array<double, 3> j{slope([&](double h) { return f(h, 0, 0); }, kStep),
                                      slope([&](double h) { return f(0, h, 0); }, kStep),
                                      slope([&](double h) { return f(0, 0, h); }, kStep)};
        // Skip the creases of the interpolation, where both sides differ.
        if (std::abs(f(kStep, 0, 0) + f(-kStep, 0, 0) - 2.0 * here) +
                std::abs(f(0, kStep, 0) + f(0, -kStep, 0) - 2.0 * here) +
                std::abs(f(0, 0, kStep) + f(0, 0, -kStep) - 2.0 * here) >
            2e-4) {
            continue;
        }
        ++checked;
        const MatchObjective::Linearized at = rays.objective->linearize(P);
        CAPTURE(round, here);
        for (std::size_t k = 0; k < 3; ++k) {
            REQUIRE(at.slope[k] == Approx(j[k]).epsilon(0.05).margin(0.06));
            REQUIRE(at.missing[k] == Approx((1.0 - here) * at.slope[k]).margin(1e-5));
        }
        const auto& g = at.slope;
        REQUIRE(at.information.xx == Approx(g[0] * g[0]).margin(1e-4));
        REQUIRE(at.information.xy == Approx(g[0] * g[1]).margin(1e-4));
        REQUIRE(at.information.yy == Approx(g[1] * g[1]).margin(1e-4));
        REQUIRE(at.information.xt == Approx(g[0] * g[2]).margin(1e-4));
        REQUIRE(at.information.yt == Approx(g[1] * g[2]).margin(1e-4));
        REQUIRE(at.information.tt == Approx(g[2] * g[2]).margin(1e-4));
        REQUIRE(at.steepness / kResolution_m == Approx(std::hypot(g[0], g[1])).margin(1e-4));
    }
    CHECK(checked > 200);
}

TEST_CASE("a ray on a straight surface counts across the surface only, a critical one in all directions") {
    auto world = make_large<MapAndField>();
    // A wall along x that ends at 0.5 m: beyond its end nothing is drawn.
    for (std::int32_t x = -40; x < 10; ++x) {
        world->set({.x = x, .y = 20}, kOccupiedCell);
    }
    const bool is_critical = GENERATE(false, true);
    Rays rays;
    for (int i = 0; i < 21; ++i) {
        rays.points->beam[rays.points->count] = static_cast<std::uint16_t>(i);
        rays.add(0.05 * i, 1.0 + 0.5 * kResolution_m, is_critical);
    }
    rays.normals.measure(*rays.points);
    rays.load();
    REQUIRE(rays.objective->aim(world->field(), {}, kPrior));
    const auto at = rays.objective->linearize({.x_m = 0.0, .y_m = 0.02, .theta_rad = 0.0});
    CHECK(at.slope[1] < -0.1);
    if (is_critical) {
        CHECK(at.slope[0] < -0.05);  // back to where the wall has been drawn
        CHECK(at.information.xx > 0.05);
    } else {
        CHECK(at.slope[0] == Approx(0.0).margin(1e-4));
        CHECK(at.information.xx == Approx(0.0).margin(1e-6));
    }
}
