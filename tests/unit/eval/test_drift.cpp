#include <catch2/catch.hpp>
#include <cmath>

#include "core/base/trig.hpp"
#include "tools/eval/drift.hpp"

using namespace crspf;
using namespace crspf::eval;
using Path = std::vector<Eigen::Isometry3d>;

namespace {

Eigen::Isometry3d step(double forward_m, double turn_rad) {
    Eigen::Isometry3d s = Eigen::Isometry3d::Identity();
    s.linear() = Eigen::AngleAxisd(turn_rad, Eigen::Vector3d::UnitY()).toRotationMatrix();
    s.translation() = Eigen::Vector3d(0.0, 0.0, forward_m);
    return s;
}

Path drive(std::size_t poses, double forward_m, double turn_rad) {
    Path path{Eigen::Isometry3d::Identity()};
    while (path.size() < poses) {
        path.push_back(path.back() * step(forward_m, turn_rad));
    }
    return path;
}

}  // namespace

TEST_CASE("drift: a scale that is 2 % too long is 2 %, of any length", "[eval][drift]") {
    const Drift d = drift(drive(301, 1.02, 0.0), drive(301, 1.0, 0.0), kitti_lengths_m(300.0), kitti_step(300.0));
    CHECK(d.path_m == Approx(300.0));
    REQUIRE(d.lengths.size() == 3);
    CHECK(d.lengths[0].length_m == 100.0);
    CHECK(d.lengths[0].stretches == 21);  // 0, 10 ... 200
    CHECK(d.lengths[2].stretches == 1);
    for (const DriftAtLength& at : d.lengths) {
        CHECK(at.translation == Approx(0.02));
        CHECK(at.rotation_deg_per_m == Approx(0.0).margin(1e-6));
    }
    CHECK(d.stretches == 21 + 11 + 1);
    CHECK(d.translation == Approx(0.02));
    CHECK(d.end_translation == Approx(0.02));
}

TEST_CASE("drift: a heading that turns by itself shows in both", "[eval][drift]") {
    const double turn_rad = radians(0.01);
    const Drift d = drift(drive(60, 1.0, turn_rad), drive(60, 1.0, 0.0), std::vector{50.0}, 1);
    REQUIRE(d.lengths.size() == 1);
    CHECK(d.lengths[0].stretches == 10);
    CHECK(d.lengths[0].rotation_deg_per_m == Approx(0.01));
    // Half of the angle at the end, along the way.
    CHECK(d.lengths[0].translation == Approx(0.5 * 50.0 * turn_rad).epsilon(0.05));
}

TEST_CASE("drift: a short path has short lengths, and one too short for them only its end", "[eval][drift]") {
    CHECK(kitti_lengths_m(59.9).front() == 10.0);
    CHECK(kitti_step(59.9) == 1);
    CHECK(kitti_lengths_m(100.0).front() == 100.0);
    const Drift d = drift(drive(5, 1.1, 0.0), drive(5, 1.0, 0.0), kitti_lengths_m(4.0), 1);
    CHECK(d.lengths.empty());
    CHECK(d.stretches == 0);
    CHECK(d.end_translation == Approx(0.1));
    const Drift standing = drift(drive(5, 0.0, 0.0), drive(5, 0.0, 0.0), kitti_lengths_m(0.0), 1);
    CHECK(standing.end_translation == 0.0);
}
