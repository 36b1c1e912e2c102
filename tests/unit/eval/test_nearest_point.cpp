#include <algorithm>
#include <catch2/catch.hpp>
#include <cstdint>
#include <limits>

#include "tools/eval/nearest_point.hpp"

using crspf::eval::NearestPoint;
using Eigen::Vector2d;

TEST_CASE("The nearest point is the one that trying all finds", "[eval][nearest]") {
    std::uint32_t state = 12345;
    const auto next = [&state] {
        state = state * 1664525U + 1013904223U;
        return static_cast<double>(state >> 22U) / 64.0;  // few different values: many equal coordinates
    };
    std::vector<Vector2d> points;
    points.reserve(1000);
    for (int i = 0; i < 1000; ++i) {
        points.emplace_back(next(), next());
    }
    const NearestPoint nearest(points);
    for (int i = 0; i < 500; ++i) {
        const Vector2d query(next() * 1.5 - 4.0, next() * 1.5 - 4.0);
        double expected = std::numeric_limits<double>::infinity();
        for (const Vector2d& p : points) {
            expected = std::min(expected, (p - query).norm());
        }
        CHECK(nearest.distance(query) == Approx(expected).margin(1e-12));
    }
}

TEST_CASE("Beyond the limit the distance is the limit", "[eval][nearest]") {
    const NearestPoint nearest({Vector2d(0.0, 0.0), Vector2d(10.0, 0.0)});
    CHECK(nearest.distance(Vector2d(0.0, 3.0), 5.0) == 3.0);
    CHECK(nearest.distance(Vector2d(5.0, 3.0), 5.0) == 5.0);
    CHECK(NearestPoint({}).distance(Vector2d(1.0, 1.0), 2.0) == 2.0);
}
