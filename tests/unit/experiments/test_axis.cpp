#include <catch2/catch.hpp>
#include <cmath>
#include <limits>

#include "tools/experiments/report/axis.hpp"

using crspf::experiments::Axis;
using crspf::experiments::axis_of;
using crspf::experiments::close_axis_of;
using crspf::experiments::Extent;
using crspf::experiments::has_place;
using crspf::experiments::Tick;
using crspf::experiments::ticks_of;

namespace {

std::vector<std::string> labels(const Axis& axis, int most) {
    std::vector<std::string> all;
    for (const Tick& tick : ticks_of(axis, most)) {
        all.push_back(tick.label);
    }
    return all;
}

using Labels = std::vector<std::string>;

}  // namespace

TEST_CASE("Ticks stand at steps of 1, 2 or 5", "[experiments][axis]") {
    CHECK(labels({0.0, 10.0}, 5) == Labels{"0", "2", "4", "6", "8", "10"});
    CHECK(labels({0.0, 0.9}, 10) == Labels{"0.0", "0.1", "0.2", "0.3", "0.4", "0.5", "0.6", "0.7", "0.8", "0.9"});
    CHECK(labels({-3.0, 21.0}, 6) == Labels{"0", "5", "10", "15", "20"});
    CHECK(labels({-0.04, 0.04}, 4) == Labels{"-0.04", "-0.02", "0.00", "0.02", "0.04"});
}

TEST_CASE("Ticks of large and of small values tell one from the next", "[experiments][axis]") {
    CHECK(labels({0.0, 4e9}, 4) == Labels{"0", "1e+09", "2e+09", "3e+09", "4e+09"});
    CHECK(labels({0.0, 2e-7}, 2) == Labels{"0", "1e-07", "2e-07"});
    const Labels near = labels({1.0e7, 1.0e7 + 4.0}, 4);
    REQUIRE(near.size() == 5);
    CHECK(near[1] == "10000001");
}

TEST_CASE("A log axis has its ticks at powers of ten, and between them where there is room", "[experiments][axis]") {
    CHECK(labels({0.01, 1000.0, true}, 8) == Labels{"0.01", "0.1", "1", "10", "100", "1000"});
    CHECK(labels({1.0, 10.0, true}, 8) == Labels{"1", "2", "5", "10"});
    CHECK(labels({1e-20, 1e20, true}, 8).size() <= 9);
    CHECK(labels({1e-8, 1e-6, true}, 5) == Labels{"1e-8", "1e-7", "1e-6"});
}

TEST_CASE("A log axis spans whole decades", "[experiments][axis]") {
    const Axis axis = axis_of({3.0, 400.0}, true);
    CHECK(axis.low == Approx(1.0));
    CHECK(axis.high == Approx(1000.0));
    CHECK(axis.share_of(10.0) == Approx(1.0 / 3.0));
    const Axis one = axis_of({100.0, 100.0}, true);
    CHECK(one.low == Approx(100.0));
    CHECK(one.high == Approx(1000.0));
}

TEST_CASE("A linear axis begins at zero where that is near", "[experiments][axis]") {
    CHECK(axis_of({1.0, 10.0}, false).low == 0.0);
    CHECK(axis_of({-10.0, -1.0}, false).high == 0.0);
    CHECK(axis_of({8.0, 10.0}, false).low == Approx(7.94));
    CHECK(axis_of({-1.0, 10.0}, false).low < -1.0);
    CHECK(close_axis_of({1.0, 10.0}).low == Approx(0.73));
}

TEST_CASE("An axis of nothing, of one value and of nearly one value is still an axis", "[experiments][axis]") {
    for (const bool log : {false, true}) {
        for (const Extent extent :
             {Extent{}, Extent{7.0, 7.0}, Extent{1e9, std::nextafter(1e9, 2e9)}, Extent{1e-300, 1e-300}}) {
            const Axis axis = axis_of(extent, log);
            CHECK(axis.low < axis.high);
            CHECK(ticks_of(axis, 5).size() >= 2);
            CHECK(ticks_of(axis, 5).size() < 20);
        }
    }
    CHECK(axis_of({0.0, 0.0}, false).low == -1.0);
}

TEST_CASE("What no axis can show has no place on it", "[experiments][axis]") {
    CHECK(has_place(-1.0, false));
    CHECK_FALSE(has_place(std::numeric_limits<double>::quiet_NaN(), false));
    CHECK_FALSE(has_place(std::numeric_limits<double>::infinity(), false));
    CHECK_FALSE(has_place(std::numeric_limits<double>::max(), false));
    CHECK_FALSE(has_place(0.0, true));
    CHECK_FALSE(has_place(-1.0, true));
}
