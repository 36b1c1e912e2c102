#include <catch2/catch.hpp>
#include <cmath>
#include <memory>
#include <vector>

#include "core/slam/critical_rays.hpp"
#include "core/slam/scan_points.hpp"
#include "tests/unit/core/synthetic.hpp"

using namespace crspf;
using namespace crspf::test;

namespace {

constexpr double kNoise_m = 0.01;

struct Point {
    double x_m;
    double y_m;
};

/// Selects the critical rays of a scan taken at the origin of base_link.
class Selection {
 public:
    explicit Selection(const CriticalRaysParams& params = {}, double noise_m = kNoise_m)
        : rays_(std::make_unique<CriticalRays>(params, noise_m)) {}

    std::vector<Point> of(const Scan& scan) {
        ScanProjector({}, false).project(scan, Odometry({}), *points_);
        return select();
    }
    /// A chain of neighbouring beams whose points are given; `reach_m` is the largest jump that is still one surface.
    std::vector<Point> of(const std::vector<Point>& chain, double reach_m) {
        points_->count = static_cast<std::uint32_t>(chain.size());
        points_->angle_increment_rad = 0.01;
        for (std::uint32_t i = 0; i < points_->count; ++i) {
            points_->x_m[i] = static_cast<float>(chain[i].x_m);
            points_->y_m[i] = static_cast<float>(chain[i].y_m);
            points_->range_m[i] = static_cast<float>(reach_m / (0.01 * 5.758770483143634));
            points_->beam[i] = static_cast<std::uint16_t>(i);
        }
        return select();
    }
    [[nodiscard]] std::vector<std::uint32_t> indices() const {
        std::vector<std::uint32_t> result;
        for (std::uint32_t i = 0; i < capacity::kBeams; ++i) {
            if (critical_[i]) {
                result.push_back(i);
            }
        }
        return result;
    }

 private:
    std::vector<Point> select() {
        const std::uint32_t n = rays_->select(*points_, critical_);
        std::vector<Point> found;
        for (std::uint32_t i = 0; i < points_->count; ++i) {
            if (critical_[i]) {
                found.push_back({static_cast<double>(points_->x_m[i]), static_cast<double>(points_->y_m[i])});
            }
        }
        REQUIRE(found.size() == n);
        return found;
    }

    std::unique_ptr<CriticalRays> rays_;
    std::unique_ptr<ScanPoints> points_ = std::make_unique<ScanPoints>();
    std::array<bool, capacity::kBeams> critical_{};
};

int near(const std::vector<Point>& found, Point corner, double within_m) {
    int count = 0;
    for (const Point& p : found) {
        count += std::hypot(p.x_m - corner.x_m, p.y_m - corner.y_m) < within_m ? 1 : 0;
    }
    return count;
}

/// All round, with the seam in the middle of the wall behind the robot.
Scan full_turn() {
    return beams_of(720, radians(-179.75), radians(179.75));
}

/// Two arms of `length` points each that meet at the origin; `opening_rad` between them.
std::vector<Point> bend(int length, double spacing_m, double opening_rad) {
    std::vector<Point> chain;
    for (int k = -length; k <= length; ++k) {
        const double along = std::abs(k) * spacing_m;
        const double side = k < 0 ? -0.5 * opening_rad : 0.5 * opening_rad;
        chain.push_back({along * std::cos(side), along * std::sin(side)});
    }
    return chain;
}

}  // namespace

TEST_CASE("a square room has four critical rays, one in each corner") {
    Scan scan = full_turn();
    const Pose2 robot{.x_m = 0.3, .y_m = -0.2, .theta_rad = 0.0};
    measure_at(scan, square_room(3.0), robot);
    const std::vector<Point> found = Selection().of(scan);
    CHECK(found.size() == 4);
    for (const double x : {-3.0, 3.0}) {
        for (const double y : {-3.0, 3.0}) {
            CAPTURE(x, y);
            CHECK(near(found, {x - robot.x_m, y - robot.y_m}, 0.06) == 1);
        }
    }
}

TEST_CASE("noise of the lidar makes no corners of walls and hides none") {
    Rng rng(31);
    for (int round = 0; round < 20; ++round) {
        Scan scan = full_turn();
        measure_at(scan, square_room(3.0), {});
        for (std::uint32_t i = 0; i < scan.count; ++i) {
            scan.range_m[i] += static_cast<float>(kNoise_m * rng.symmetric());
        }
        const std::vector<Point> found = Selection().of(scan);
        int at_corners = 0;
        for (const double x : {-3.0, 3.0}) {
            for (const double y : {-3.0, 3.0}) {
                const int here = near(found, {x, y}, 0.2);
                CHECK(here >= 1);
                at_corners += here;
            }
        }
        CHECK(at_corners == static_cast<int>(found.size()));
    }
}

TEST_CASE("an edge that points at the robot is critical, a blunt one is not") {
    const double opening_deg = GENERATE(60.0, 90.0, 120.0, 130.0, 150.0, 180.0);
    CAPTURE(opening_deg);
    // The wall's two halves run back from (2, 0).
    const double half = radians(0.5 * opening_deg);
    const double back = 2.0 * std::cos(half);
    const double side = 2.0 * std::sin(half);
    Scan scan = beams_of(361, radians(-90.0), radians(90.0));
    measure_at(scan, {{2.0, 0.0, 2.0 + back, side}, {2.0, 0.0, 2.0 + back, -side}}, {});
    const CriticalRaysParams params{.angle_max_rad = radians(125.0)};
    const std::vector<Point> found = Selection(params).of(scan);
    if (opening_deg < 125.0) {
        CHECK(found.size() == 1);
        CHECK(near(found, {2.0, 0.0}, 0.03) == 1);
    } else {
        CHECK(found.empty());
    }
}

TEST_CASE("the threshold angle divides") {
    const CriticalRaysParams params{.angle_max_rad = radians(100.0)};
    CHECK(Selection(params).of(bend(10, 0.1, radians(99.0)), 1.0).size() == 1);
    CHECK(Selection(params).of(bend(10, 0.1, radians(101.0)), 1.0).empty());
}

TEST_CASE("a round wall has no corners") {
    Scan scan = full_turn();
    for (std::uint32_t i = 0; i < scan.count; ++i) {
        scan.beam[i] = Beam::kHit;
        scan.range_m[i] = 3.0F;
    }
    CHECK(Selection().of(scan).empty());
}

TEST_CASE("of a run of equal angles the first is critical") {
    // A zigzag on whole numbers: every inner point's angle is exactly 90 degrees.
    std::vector<Point> zigzag;
    zigzag.reserve(60);
    for (int i = 0; i < 60; ++i) {
        zigzag.push_back({static_cast<double>(i), static_cast<double>(i % 2)});
    }
    Selection selection({.window_min = 1, .window_max = 1, .angle_max_rad = radians(125.0)}, 0.0);
    REQUIRE(selection.of(zigzag, 2.0).size() == 1);
    CHECK(selection.indices().front() == 1);
}

TEST_CASE("no two critical rays share a window, and one is the sharpest of its own") {
    Rng rng(32);
    Selection selection;
    for (int round = 0; round < 100; ++round) {
        std::vector<Point> chain;
        Point at{};
        for (int i = 0; i < 400; ++i) {
            at.x_m += 0.05 + 0.1 * rng.symmetric();
            at.y_m += 0.1 * rng.symmetric();
            chain.push_back(at);
        }
        const bool any = !selection.of(chain, 1.0).empty();
        CHECK(any);
        const std::vector<std::uint32_t> found = selection.indices();
        for (std::size_t k = 1; k < found.size(); ++k) {
            REQUIRE(found[k] - found[k - 1] > static_cast<std::uint32_t>(CriticalRaysParams{}.window_max));
        }
    }
}

TEST_CASE("a missing beam breaks the chain") {
    Scan scan = full_turn();
    measure_at(scan, square_room(3.0), {});
    const auto corner = static_cast<std::uint32_t>((radians(45.0) - scan.angle_min_rad) / scan.angle_increment_rad);
    REQUIRE(near(Selection().of(scan), {3.0, 3.0}, 0.1) == 1);
    SECTION("beside the corner: it cannot be told") {
        scan.beam[corner + 2] = GENERATE(Beam::kInvalid, Beam::kNoReturn);
        const std::vector<Point> found = Selection().of(scan);
        CHECK(near(found, {3.0, 3.0}, 0.3) == 0);
        CHECK(found.size() == 3);
    }
    SECTION("far from it: nothing changes") {
        scan.beam[corner + 40] = Beam::kInvalid;
        CHECK(Selection().of(scan).size() == 4);
    }
}

TEST_CASE("the edge of an occlusion is no corner") {
    // A near wall ends at (2, 0) in front of a far one. With the gap closed there is a real corner.
    const bool closed = GENERATE(false, true);
    Walls walls{{2.0, 0.0, 2.0, -3.0}, {4.0, -3.0, 4.0, 3.0}};
    if (closed) {
        walls = {{2.0, 0.0, 2.0, -3.0}, {2.0, 0.0, 4.0, 3.0}};
    }
    Scan scan = beams_of(241, radians(-30.0), radians(30.0));
    measure_at(scan, walls, {.x_m = 0.0, .y_m = closed ? 1.0 : 0.0, .theta_rad = 0.0});
    // Two walls at 124 degrees: take a blunter threshold so that the closed one counts.
    const std::vector<Point> found = Selection({.angle_max_rad = radians(160.0)}).of(scan);
    CHECK(found.size() == (closed ? 1U : 0U));
}

TEST_CASE("an angle takes both of its arms") {
    const CriticalRaysParams params;
    const auto full = bend(params.window_min, 0.1, radians(90.0));
    REQUIRE(full.size() == 2 * static_cast<std::size_t>(params.window_min) + 1);
    Selection selection(params);
    CHECK(selection.of(full, 1.0).size() == 1);
    CHECK(selection.of({full.begin(), full.end() - 1}, 1.0).empty());
    CHECK(selection.of({full.begin() + 1, full.end()}, 1.0).empty());
    CHECK(selection.of({}, 1.0).empty());
    CHECK(selection.of({full.front()}, 1.0).empty());
}

TEST_CASE("arms that drown in the noise say nothing") {
    const auto tiny = bend(10, 0.002, radians(90.0));  // arms of 8 to 16 mm
    CHECK(Selection({}, 0.010).of(tiny, 1.0).empty());
    CHECK(Selection({}, 0.001).of(tiny, 1.0).size() == 1);
}

TEST_CASE("switched off there are none") {
    Selection selection({.enabled = false});
    CHECK(selection.of(bend(10, 0.1, radians(90.0)), 1.0).empty());
    Selection on;
    CHECK(on.of(bend(10, 0.1, radians(90.0)), 1.0).size() == 1);
}

TEST_CASE("nothing is left over from the scan before") {
    Selection selection;
    REQUIRE(selection.of(bend(20, 0.1, radians(90.0)), 1.0).size() == 1);
    CHECK(selection.of(bend(20, 0.1, radians(180.0)), 1.0).empty());
    CHECK(selection.of(bend(2, 0.1, radians(90.0)), 1.0).empty());
    CHECK(selection.indices().empty());
}
