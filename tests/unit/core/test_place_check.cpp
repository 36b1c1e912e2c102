#include <catch2/catch.hpp>
#include <cmath>
#include <vector>

#include "core/slam/place_check.hpp"
#include "tests/unit/core/synthetic.hpp"

using namespace crspf;
using namespace crspf::test;

namespace {

constexpr double kResolution_m = 0.05;
constexpr double kTolerance_m = 0.1;  // two cells

/// A map of 100 x 100 cells, all free, to draw on.
class Sheet {
 public:
    Sheet() : cells_(std::size_t{kSide} * kSide, kFreeCell) {}
    void column(int x, int y_begin, int y_end, Evidence evidence) {
        for (int y = y_begin; y < y_end; ++y) {
            cells_[static_cast<std::size_t>(y) * kSide + static_cast<std::size_t>(x)] = evidence;
        }
    }
    void columns(int x_begin, int x_end, Evidence evidence) {
        for (int x = x_begin; x < x_end; ++x) {
            column(x, 0, kSide, evidence);
        }
    }
    [[nodiscard]] MapView view() const {
        return {.cells = cells_, .width = kSide, .height = kSide, .resolution_m = kResolution_m, .P_map_corner = {}};
    }

 private:
    static constexpr int kSide = 100;
    std::vector<Evidence> cells_;
};

/// One beam straight ahead.
SparseScan ahead(double range_m) {
    SparseScan scan;
    scan.count = 1;
    scan.x_m[0] = static_cast<float>(range_m);
    scan.rms_range_m = range_m;
    return scan;
}

constexpr Pose2 kPlace{.x_m = 0.525, .y_m = 2.525, .theta_rad = 0.0};

double share(const Sheet& sheet, const SparseScan& scan) {
    const MapView map = sheet.view();
    return PlaceCheck(map, scan, kTolerance_m).share(kPlace);
}

}  // namespace

TEST_CASE("a hit on a wall is explained, beside it less, in open or unseen land not at all") {
    Sheet sheet;
    sheet.column(50, 0, 100, kOccupiedCell);  // 2 m ahead
    CHECK(share(sheet, ahead(2.0)) == 1.0);
    CHECK(share(sheet, ahead(2.05)) == Approx(2.0 / 3.0));
    CHECK(share(sheet, ahead(1.9)) == Approx(1.0 / 3.0));
    CHECK(share(sheet, ahead(1.8)) == 0.0);
    CHECK(share(sheet, ahead(100.0)) == 0.0);
    CHECK(share(sheet, SparseScan{}) == 0.0);
}

TEST_CASE("a beam does not pass through a wall, but it grazes one, and passes what is smaller than the tolerance") {
    Sheet sheet;
    sheet.column(50, 0, 100, kOccupiedCell);
    const SparseScan scan = ahead(2.0);
    sheet.column(30, 50, 51, kOccupiedCell);  // the beam's own row only
    CHECK(share(sheet, scan) == 1.0);
    sheet.column(30, 50, 60, kOccupiedCell);  // from here to the left
    CHECK(share(sheet, scan) == 1.0);
    sheet.column(30, 40, 60, kOccupiedCell);  // to both sides
    CHECK(share(sheet, scan) == 0.0);
}

TEST_CASE("a beam through unseen land explains nothing") {
    Sheet sheet;
    sheet.column(50, 0, 100, kOccupiedCell);
    sheet.columns(20, 30, kUnseen);
    CHECK(share(sheet, ahead(2.0)) == 1.0);  // a gap
    sheet.columns(12, 45, kUnseen);
    CHECK(share(sheet, ahead(2.0)) == 0.0);
}

TEST_CASE("the climb finds the top and says how many poses it took") {
    Sheet sheet;
    sheet.column(80, 20, 80, kOccupiedCell);
    for (int x = 20; x < 80; ++x) {
        sheet.column(x, 80, 81, kOccupiedCell);
    }
    SparseScan scan;
    for (int i = 0; i < 10; ++i) {
        scan.x_m[scan.count] = 1.5F;
        scan.y_m[scan.count++] = static_cast<float>(-1.0 + 0.1 * i);
        scan.x_m[scan.count] = static_cast<float>(-1.0 + 0.1 * i);
        scan.y_m[scan.count++] = 1.5F;
    }
    const MapView map = sheet.view();
    const PlaceCheck check(map, scan, kTolerance_m);
    const Pose2 truth{.x_m = 2.525, .y_m = 2.525, .theta_rad = 0.0};
    REQUIRE(check.share(truth) == 1.0);
    const Pose2 start{.x_m = 2.45, .y_m = 2.6, .theta_rad = 0.02};
    REQUIRE(check.share(start) < 0.7);
    const auto top = check.climb(start, 0.05, 0.01);
    CHECK(check.share(top.P_corner_lidar) > 0.9);
    CHECK(top.evaluations > 6);
    CHECK(top.evaluations <= PlaceCheck::kClimbEvaluations);
    // Where there is nothing to climb it stays.
    const Pose2 open{.x_m = 1.5, .y_m = 1.5, .theta_rad = 3.0};
    CHECK(PlaceCheck(map, ahead(0.3), kTolerance_m).climb(open, 0.05, 0.01).P_corner_lidar == open);
}
