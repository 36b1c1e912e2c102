#include <catch2/catch.hpp>
#include <cmath>
#include <limits>

#include "core/slam/sparse_scan.hpp"
#include "tests/unit/core/synthetic.hpp"

using namespace crspf;
using namespace crspf::test;

namespace {

void add(ScanPoints& points, double x_m, double y_m) {
    points.x_m[points.count] = static_cast<float>(x_m);
    points.y_m[points.count] = static_cast<float>(y_m);
    ++points.count;
}

}  // namespace

TEST_CASE("hits lie apart, seen from the lidar") {
    const auto points = std::make_unique<ScanPoints>();
    points->P_base_first_lidar = {.x_m = 0.5, .y_m = 0.0, .theta_rad = kPi / 2.0};
    for (int i = 0; i < 100; ++i) {
        add(*points, 2.5, 0.01 * i);
    }
    const auto scan = std::make_unique<SparseScan>();
    scan->take(*points, 0.1);
    REQUIRE(scan->count == 10);
    CHECK(static_cast<double>(scan->x_m[0]) == Approx(0.0).margin(1e-6));  // 2 m to the lidar's right
    CHECK(static_cast<double>(scan->y_m[0]) == Approx(-2.0));
    for (std::uint32_t i = 1; i < scan->count; ++i) {
        CHECK(static_cast<double>(scan->x_m[i] - scan->x_m[i - 1]) > 0.099);
    }
    CHECK(scan->rms_range_m > 2.0);
    CHECK(scan->rms_range_m < 2.2);
}

TEST_CASE("of too many hits an even choice is taken, and nothing of a scan without hits") {
    const auto points = std::make_unique<ScanPoints>();
    for (int i = 0; i < 600; ++i) {
        add(*points, 1.0 + i, 0.0);
    }
    const auto scan = std::make_unique<SparseScan>();
    scan->take(*points, 0.1);
    CHECK(scan->count == 200);
    CHECK(static_cast<double>(scan->x_m[1] - scan->x_m[0]) == Approx(3.0));
    scan->take(ScanPoints{}, 0.1);
    CHECK(scan->count == 0);
    CHECK(scan->rms_range_m == 0.0);
}

TEST_CASE("hits that are none are left out") {
    const auto points = std::make_unique<ScanPoints>();
    add(*points, std::numeric_limits<double>::quiet_NaN(), 0.0);
    add(*points, 1.0, std::numeric_limits<double>::infinity());
    add(*points, 5000.0, 0.0);
    add(*points, 3.0, 4.0);
    const auto scan = std::make_unique<SparseScan>();
    scan->take(*points, 0.1);
    CHECK(scan->count == 1);
    CHECK(scan->rms_range_m == Approx(5.0));
}
