#include <catch2/catch.hpp>
#include <cmath>

#include "tests/unit/eval/wall_scans.hpp"
#include "tools/eval/scan_alignment.hpp"

using namespace crspf;
using namespace crspf::eval;
using crspf::test::add_box;
using crspf::test::turn_between;
using crspf::test::wall_scan;
using crspf::test::Walls;

namespace {

/// 7 m by 5 m, with a cupboard and a pillar: nothing of it looks the same twice.
Walls furnished_room() {
    Walls walls;
    add_box(walls, -3.0, -2.0, 4.0, 3.0);
    add_box(walls, 2.0, 2.2, 3.2, 3.0);
    add_box(walls, 3.0, -0.4, 3.3, -0.1);
    return walls;
}

Walls bare_corridor() {
    return {{-100.0, -1.0, 100.0, -1.0}, {-100.0, 1.2, 100.0, 1.2}};
}

/// Pilasters on both sides, every metre, all alike.
Walls colonnade() {
    Walls walls = bare_corridor();
    for (int i = -40; i <= 40; ++i) {
        add_box(walls, i - 0.15, -1.0, i + 0.15, -0.7);
        add_box(walls, i - 0.15, 0.9, i + 0.15, 1.2);
    }
    return walls;
}

}  // namespace

TEST_CASE("A scan is laid on another to a centimetre, however wrong the guess", "[eval][alignment]") {
    Rng rng(3);
    const Pose2 P_world_reference{.x_m = -1.0, .y_m = 0.2, .theta_rad = 0.1};
    const Pose2 P_reference_scan{.x_m = 0.5, .y_m = -0.3, .theta_rad = radians(15.0)};
    const ScanHits reference = wall_scan(furnished_room(), P_world_reference, rng);
    const ScanHits scan = wall_scan(furnished_room(), P_world_reference * P_reference_scan, rng);
    const Pose2 off = GENERATE(Pose2{}, Pose2{.x_m = 0.4, .y_m = 0.0, .theta_rad = radians(3.0)},
                               Pose2{.x_m = -1.0, .y_m = 1.2, .theta_rad = radians(-14.0)});
    const ScanAlignment found = align_scans(reference, scan, P_reference_scan * off);
    REQUIRE(found.verdict == AlignmentVerdict::kGood);
    CHECK(std::hypot(found.P_reference_scan.x_m - P_reference_scan.x_m,
                     found.P_reference_scan.y_m - P_reference_scan.y_m) < 0.01);
    CHECK(turn_between(found.P_reference_scan.theta_rad, P_reference_scan.theta_rad) < radians(0.3));
}

TEST_CASE("The lidar need not sit at base_link", "[eval][alignment]") {
    Rng rng(4);
    const Pose2 P_base_lidar{.x_m = 0.3, .y_m = -0.1, .theta_rad = radians(20.0)};
    const Pose2 P_reference_scan{.x_m = 0.4, .y_m = 0.2, .theta_rad = radians(-10.0)};
    const auto mounted = [&](const Pose2& P_world_base) {
        ScanHits hits = wall_scan(furnished_room(), P_world_base * P_base_lidar, rng);
        const SinCos turn = sin_cos(P_base_lidar.theta_rad);
        hits.lidar = {P_base_lidar.x_m, P_base_lidar.y_m};
        for (Eigen::Vector2f& p : hits.points) {
            const Eigen::Vector2d q = p.cast<double>();
            p = (Eigen::Vector2d(turn.cos * q.x() - turn.sin * q.y(), turn.sin * q.x() + turn.cos * q.y()) + hits.lidar)
                    .cast<float>();
        }
        return hits;
    };
    const ScanHits reference = mounted({});
    const ScanAlignment found = align_scans(reference, mounted(P_reference_scan), {});
    REQUIRE(found.verdict == AlignmentVerdict::kGood);
    CHECK(found.P_reference_scan.x_m == Approx(P_reference_scan.x_m).margin(0.01));
    CHECK(found.P_reference_scan.y_m == Approx(P_reference_scan.y_m).margin(0.01));
    CHECK(turn_between(found.P_reference_scan.theta_rad, P_reference_scan.theta_rad) < radians(0.3));
}

TEST_CASE("Along a bare corridor nothing holds the scan", "[eval][alignment]") {
    Rng rng(5);
    const ScanHits reference = wall_scan(bare_corridor(), {}, rng);
    const ScanHits scan = wall_scan(bare_corridor(), {.x_m = 0.4, .y_m = 0.1}, rng);
    CHECK(align_scans(reference, scan, {}).verdict == AlignmentVerdict::kDegenerate);
}

TEST_CASE("Where two places fit alike there is no answer", "[eval][alignment]") {
    Rng rng(6);
    const ScanHits reference = wall_scan(colonnade(), {}, rng);
    const ScanHits scan = wall_scan(colonnade(), {.x_m = 0.5}, rng);
    CHECK(align_scans(reference, scan, {.x_m = 0.1}).verdict == AlignmentVerdict::kAmbiguous);
}

TEST_CASE("Scans of two places do not fit", "[eval][alignment]") {
    Rng rng(7);
    Walls other;
    add_box(other, -1.0, -6.0, 9.0, 1.0);
    add_box(other, 2.0, -3.0, 3.0, -2.0);
    const ScanHits reference = wall_scan(furnished_room(), {}, rng);
    CHECK(align_scans(reference, wall_scan(other, {}, rng), {}).verdict == AlignmentVerdict::kNoFit);
}

TEST_CASE("A hit or two is no scan", "[eval][alignment]") {
    Rng rng(8);
    const ScanHits reference = wall_scan(furnished_room(), {}, rng);
    ScanHits hardly_any = reference;
    hardly_any.points.resize(2);
    CHECK(align_scans(reference, hardly_any, {}).verdict == AlignmentVerdict::kTooFewPoints);
    CHECK(align_scans(hardly_any, reference, {}).verdict == AlignmentVerdict::kTooFewPoints);
    CHECK(align_scans({}, {}, {}).verdict == AlignmentVerdict::kTooFewPoints);
}
