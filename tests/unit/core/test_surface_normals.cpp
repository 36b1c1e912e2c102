#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <memory>

#include "core/slam/scan_points.hpp"
#include "core/slam/surface_normals.hpp"
#include "tests/unit/core/synthetic.hpp"

using namespace crspf;
using namespace crspf::test;

namespace {

constexpr double kNoise_m = 0.01;

/// A scan of `walls` from the origin, one beam a degree, with `noise_m` of range noise.
std::unique_ptr<ScanPoints> scan_of(const Walls& walls, double noise_m = 0.0) {
    Scan scan = beams_of(180, radians(-90.0), radians(89.0));
    measure_at(scan, walls, {});
    Rng rng(91);
    for (std::uint32_t i = 0; i < scan.count; ++i) {
        scan.range_m[i] += static_cast<float>(noise_m * rng.symmetric());
    }
    auto points = std::make_unique<ScanPoints>();
    ScanProjector({}, false).project(scan, Odometry({}), *points);
    return points;
}

bool has_normal(const SurfaceNormals& normals, std::size_t i) {
    return normals.x(i) != 0.0F || normals.y(i) != 0.0F;
}

}  // namespace

TEST_CASE("a wall's points face across it, whatever its direction, its length and the range noise") {
    const double heading_rad = GENERATE(0.0, 0.3, 1.2, radians(90.0), -0.7);
    const double noise_m = GENERATE(0.0, kNoise_m);
    // 2 m away, 20 m long, seen from square on to grazing.
    const SinCos r = sin_cos(heading_rad);
    const auto points = scan_of({{2.0 * r.cos + 10.0 * r.sin, 2.0 * r.sin - 10.0 * r.cos, 2.0 * r.cos - 10.0 * r.sin,
                                  2.0 * r.sin + 10.0 * r.cos}},
                                noise_m);
    REQUIRE(points->count > 60);
    SurfaceNormals normals(kNoise_m);
    normals.measure(*points);
    for (std::size_t i = 0; i < points->count; ++i) {
        CAPTURE(heading_rad, noise_m, i);
        REQUIRE(has_normal(normals, i));
        const double across = static_cast<double>(normals.x(i)) * r.cos + static_cast<double>(normals.y(i)) * r.sin;
        REQUIRE(std::abs(across) > std::cos(noise_m > 0.0 ? 0.12 : 1e-3));
        REQUIRE(std::hypot(static_cast<double>(normals.x(i)), static_cast<double>(normals.y(i))) == Approx(1.0));
    }
}

TEST_CASE("corners, edges and single points have no normal") {
    SurfaceNormals normals(kNoise_m);

    SECTION("a corner and its neighbours") {
        const auto points = scan_of({{3.0, -400.0, 3.0, 1.0}, {3.0, 1.0, -400.0, 1.0}});
        normals.measure(*points);
        const auto at = [&](std::uint16_t beam) {
            return static_cast<std::size_t>(
                std::find(points->beam.begin(), points->beam.begin() + points->count, beam) - points->beam.begin());
        };
        constexpr std::uint16_t kCorner = 108;  // the beam at 18 degrees
        CHECK_FALSE(has_normal(normals, at(kCorner)));
        CHECK_FALSE(has_normal(normals, at(kCorner + 2)));
        CHECK(has_normal(normals, at(kCorner - 20)));
        CHECK(has_normal(normals, at(kCorner + 20)));
    }
    SECTION("a step of more than ten times the range noise") {
        const auto points = scan_of({{1.0, -4.0, 1.0, 0.0}, {1.15, 0.0, 1.15, 4.0}});
        normals.measure(*points);
        int without = 0;
        for (std::size_t i = 0; i < points->count; ++i) {
            without += has_normal(normals, i) ? 0 : 1;
        }
        CHECK(without >= 4);
        CHECK(without <= 17);
    }
    SECTION("a pole and a pair of points") {
        const auto points = scan_of({{2.0, -0.01, 2.0, 0.01}, {1.0, 1.0, 1.02, 1.0}});
        REQUIRE(points->count >= 1);
        REQUIRE(points->count <= 4);
        normals.measure(*points);
        for (std::size_t i = 0; i < points->count; ++i) {
            CHECK_FALSE(has_normal(normals, i));
        }
    }
    SECTION("no point at all") {
        ScanPoints none;
        normals.measure(none);
    }
}

TEST_CASE("a missing beam ends the line") {
    auto points = scan_of({{2.0, -10.0, 2.0, 10.0}});
    for (std::size_t i = 0; i < points->count; ++i) {
        points->beam[i] = static_cast<std::uint16_t>(2 * i);
    }
    SurfaceNormals normals(kNoise_m);
    normals.measure(*points);
    for (std::size_t i = 0; i < points->count; ++i) {
        REQUIRE_FALSE(has_normal(normals, i));
    }
}
