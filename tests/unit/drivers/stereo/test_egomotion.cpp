#include <catch2/catch.hpp>
#include <cmath>
#include <vector>

#include "drivers/stereo/egomotion.hpp"
#include "tests/unit/drivers/stereo/scatter.hpp"

using namespace crspf;
using crspf::test::scatter;

namespace {

constexpr RectifiedCamera kCamera{
    .width = 640, .height = 360, .focal_px = 320.0, .cx_px = 320.0, .cy_px = 180.0, .baseline_m = 0.12};

RigidMotion motion(double x, double y, double z, double rx, double ry, double rz) {
    Vector6 v;
    v << x, y, z, rx, ry, rz;
    return motion_of(v);
}

/// What the camera sees of points here and there, before and after `P_before_after`, with noise.
std::vector<StereoMatch> scene(const RigidMotion& P_before_after, std::size_t count, double noise_px,
                               unsigned seed = 1) {
    Rng random(seed);
    const auto between = [&](double low, double high) {
        return 0.5 * (low + high + (high - low) * random.symmetric());
    };
    const auto noisy = [&](StereoPoint p) {
        p.left_u_px += noise_px * scatter(random);
        p.right_u_px += noise_px * scatter(random);
        p.v_px += noise_px * scatter(random) / std::sqrt(2.0);
        return p;
    };
    std::vector<StereoMatch> out;
    while (out.size() < count) {
        const double z = between(1.5, 15.0);
        const Eigen::Vector3d p((between(40.0, 600.0) - kCamera.cx_px) * z / kCamera.focal_px,
                                (between(20.0, 340.0) - kCamera.cy_px) * z / kCamera.focal_px, z);
        const Eigen::Vector3d after = P_before_after.inverse() * p;
        if (after.z() > 0.5) {
            out.push_back({.before = noisy(seen_at(kCamera, p)), .after = noisy(seen_at(kCamera, after))});
        }
    }
    return out;
}

Vector6 error_of(const Egomotion& found, const RigidMotion& truth) {
    return vector_of(truth.inverse() * found.P_before_after);
}

}  // namespace

TEST_CASE("egomotion: a point is where it is seen", "[stereo]") {
    const Eigen::Vector3d p(0.4, -0.3, 5.0);
    const StereoPoint seen = seen_at(kCamera, p);
    CHECK(seen.disparity_px() == Approx(320.0 * 0.12 / 5.0));
    CHECK((point_of(kCamera, seen) - p).norm() < 1e-12);
}

TEST_CASE("egomotion: a motion as six numbers and back", "[stereo]") {
    const RigidMotion m = motion(0.1, -0.2, 1.2, 0.02, -0.3, 0.05);
    CHECK((vector_of(m) - vector_of(motion_of(vector_of(m)))).norm() < 1e-12);
    CHECK((m.R * m.R.transpose() - Eigen::Matrix3d::Identity()).norm() < 1e-12);
    CHECK(vector_of(m * m.inverse()).norm() < 1e-12);
    // exp(v) m = m exp(adjoint(m^-1) v), to first order.
    Vector6 small;
    small << 1e-6, 2e-6, -1e-6, 1e-6, -2e-6, 3e-6;
    const RigidMotion a = motion_of(small) * m;
    const RigidMotion b = m * motion_of(adjoint(m.inverse()) * small);
    CHECK(vector_of(a.inverse() * b).norm() < 1e-10);
}

TEST_CASE("egomotion: without noise the motion is exact, wherever the search starts", "[stereo]") {
    const RigidMotion truth = motion(0.05, -0.02, 0.4, 0.01, 0.05, -0.02);
    EgomotionSolver solver(kCamera);
    Egomotion found;
    REQUIRE(solver.solve(scene(truth, 100, 0.0), {}, found));
    CHECK(error_of(found, truth).norm() < 1e-9);
    CHECK(found.inliers == 100);
}

TEST_CASE("egomotion: a third of the points move by themselves and are left out", "[stereo]") {
    const RigidMotion truth = motion(0.0, 0.0, 0.3, 0.0, 0.03, 0.0);
    std::vector<StereoMatch> matches = scene(truth, 100, 0.1);
    const std::vector<StereoMatch> others = scene(motion(0.5, 0.0, 0.1, 0.0, -0.05, 0.0), 50, 0.1, 7);
    matches.insert(matches.begin(), others.begin(), others.end());
    EgomotionSolver solver(kCamera);
    Egomotion found;
    REQUIRE(solver.solve(matches, {}, found));
    CHECK(error_of(found, truth).head<3>().norm() < 0.01);
    CHECK(error_of(found, truth).tail<3>().norm() < 0.002);
    CHECK(found.inliers >= 95);
    for (std::size_t i = 50; i < 150; ++i) {
        CHECK(solver.inliers()[i]);
    }
}

TEST_CASE("egomotion: the covariance is that of the errors", "[stereo]") {
    const RigidMotion truth = motion(0.02, 0.01, 0.25, 0.005, 0.03, 0.0);
    EgomotionSolver solver(kCamera);
    constexpr unsigned kRuns = 200;
    double mahalanobis = 0.0;
    Vector6 mean = Vector6::Zero();
    for (unsigned run = 1; run <= kRuns; ++run) {
        Egomotion found;
        REQUIRE(solver.solve(scene(truth, 80, 0.25, run), truth, found));
        const Vector6 error = error_of(found, truth);
        mean += error / kRuns;
        mahalanobis += error.dot(found.covariance.inverse() * error) / kRuns;
    }
    // Six degrees of freedom: 6 on average, by 0.25 either way in 200 runs.
    CHECK(mahalanobis > 4.5);
    CHECK(mahalanobis < 7.5);
    CHECK(mean.head<3>().norm() < 0.002);
}

TEST_CASE("egomotion: the same points give the same bits", "[stereo]") {
    const std::vector<StereoMatch> matches = scene(motion(0.0, 0.0, 0.3, 0.0, 0.02, 0.0), 120, 0.4);
    EgomotionSolver solver(kCamera);
    EgomotionSolver other(kCamera);
    Egomotion a;
    Egomotion b;
    REQUIRE(solver.solve(matches, {}, a));
    REQUIRE(solver.solve(matches, {}, a));
    REQUIRE(other.solve(matches, {}, b));
    CHECK(a.P_before_after.R == b.P_before_after.R);
    CHECK(a.P_before_after.t == b.P_before_after.t);
    CHECK(a.covariance == b.covariance);
}

TEST_CASE("egomotion: what tells no motion is no motion", "[stereo]") {
    EgomotionSolver solver(kCamera);
    Egomotion found;
    CHECK_FALSE(solver.solve({}, {}, found));
    CHECK_FALSE(solver.solve(scene(motion(0.0, 0.0, 0.3, 0.0, 0.0, 0.0), 11, 0.1), {}, found));
    // One point seen over and over.
    const std::vector<StereoMatch> one(50, scene({}, 1, 0.0).front());
    CHECK_FALSE(solver.solve(one, {}, found));
    // Every point goes its own way.
    std::vector<StereoMatch> crowd;
    for (unsigned i = 0; i < 100; ++i) {
        const unsigned row = i / 10;
        const double side = 0.8 * static_cast<double>(i % 10) - 4.0;
        crowd.push_back(scene(motion(side, 0.0, 0.1 * static_cast<double>(row), 0.0, 0.0, 0.0), 1, 0.0, i).front());
    }
    const bool solved = solver.solve(crowd, {}, found);
    CHECK((!solved || found.inliers < 50));
}
