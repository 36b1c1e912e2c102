#include <algorithm>
#include <catch2/catch.hpp>

#include "tools/experiments/report/curve.hpp"

using crspf::experiments::Curve;
using crspf::experiments::dots_path;
using crspf::experiments::line_path;
using crspf::experiments::Spot;
using crspf::experiments::stepped;
using crspf::experiments::thinned;
using crspf::experiments::thinned_dots;

TEST_CASE("A path tells each point to a tenth of a pixel, and none twice", "[experiments][curve]") {
    CHECK(line_path({{1.0, 2.0}, {3.04, 4.06}, {3.03, 4.05}, {5.0, 6.0}}) == "M1 2L3 4.1L5 6");
    CHECK(line_path({}).empty());
    CHECK(dots_path({{1.0, 2.0}, {3.0, 4.0}}) == "M1 2h0M3 4h0");
}

TEST_CASE("A line of one point is a dot", "[experiments][curve]") {
    CHECK(line_path({{1.0, 2.0}}) == "M1 2h0");
    CHECK(line_path({{1.0, 2.0}, {1.01, 2.0}}) == "M1 2h0");
}

TEST_CASE("A step holds its value until the next", "[experiments][curve]") {
    CHECK(stepped({{0.0, 1.0}, {2.0, 3.0}}) == Curve{{0.0, 1.0}, {2.0, 1.0}, {2.0, 3.0}});
}

TEST_CASE("A thinned line keeps its ends and its peaks", "[experiments][curve]") {
    Curve curve;
    for (int i = 0; i < 100000; ++i) {
        curve.push_back({0.001 * i, 50.0});
    }
    curve[31234].y_px = 3.0;
    curve[70001].y_px = 97.0;
    const Curve kept = thinned(curve, 3000);
    CHECK(kept.size() <= 3000);
    CHECK(kept.front() == curve.front());
    CHECK(kept.back() == curve.back());
    CHECK(std::count(kept.begin(), kept.end(), curve[31234]) == 1);
    CHECK(std::count(kept.begin(), kept.end(), curve[70001]) == 1);
    CHECK(std::is_sorted(kept.begin(), kept.end(), [](const Spot& a, const Spot& b) { return a.x_px < b.x_px; }));
    CHECK(thinned(kept, 3000) == kept);
}

TEST_CASE("Dots are thinned where they cover each other", "[experiments][curve]") {
    Curve dots(10000, Spot{5.0, 5.0});
    dots.push_back({80.0, 5.0});
    CHECK(thinned_dots(dots, 100) == Curve{{5.0, 5.0}, {80.0, 5.0}});
}
