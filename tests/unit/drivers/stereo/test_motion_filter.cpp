#include <catch2/catch.hpp>

#include "drivers/stereo/motion_filter.hpp"

using namespace crspf;

namespace {

Vector6 vector(double forward, double turn) {
    Vector6 v = Vector6::Zero();
    v(2) = forward;
    v(4) = turn;
    return v;
}

const Matrix6 kSharp = 1e-6 * Matrix6::Identity();

/// Sees itself drive at `velocity` for `steps` of 0.1 s, each from a reference of its own.
void drive(MotionFilter& filter, const Vector6& velocity, int steps) {
    for (int i = 0; i < steps; ++i) {
        filter.rebase();
        filter.predict(0.1);
        filter.update(motion_of(0.1 * velocity), kSharp);
    }
}

}  // namespace

TEST_CASE("motion filter: the velocity is learnt and carries on", "[stereo]") {
    MotionFilter filter;
    const Vector6 velocity = vector(1.5, 0.2);
    drive(filter, velocity, 20);
    CHECK((filter.velocity() - velocity).norm() < 0.02);
    filter.rebase();
    for (int i = 0; i < 20; ++i) {
        filter.predict(0.1);
    }
    // An arc of 3 m that turned by 0.4 rad.
    const Vector6 gone = vector_of(filter.P_reference_camera());
    CHECK(gone.head<3>().norm() == Approx(3.0 * std::sin(0.2) / 0.2).epsilon(0.02));
    CHECK(gone(4) == Approx(0.4).epsilon(0.05));
}

TEST_CASE("motion filter: not looking, it knows less and less", "[stereo]") {
    MotionFilter filter;
    drive(filter, vector(1.0, 0.0), 20);
    filter.rebase();
    double before = 0.0;
    for (int i = 0; i < 20; ++i) {
        filter.predict(0.1);
        const double now = filter.pose_covariance()(2, 2);
        CHECK(now > before);
        before = now;
    }
    // A walk of 1 m/s in a second, for 2 s: sqrt(8 / 3) m.
    CHECK(std::sqrt(before) == Approx(std::sqrt(8.0 / 3.0)).epsilon(0.1));
}

TEST_CASE("motion filter: a vague measurement pulls little, a sharp one all the way", "[stereo]") {
    MotionFilter filter;
    drive(filter, vector(1.0, 0.0), 20);
    filter.rebase();
    filter.predict(0.1);
    MotionFilter vague = filter;
    vague.update(motion_of(vector(0.2, 0.0)), Matrix6::Identity());
    CHECK(vector_of(vague.P_reference_camera())(2) == Approx(0.1).margin(0.005));
    filter.update(motion_of(vector(0.2, 0.0)), kSharp);
    CHECK(vector_of(filter.P_reference_camera())(2) == Approx(0.2).margin(0.005));
}

TEST_CASE("motion filter: a leap is not believed, hard braking is", "[stereo]") {
    MotionFilter filter;
    drive(filter, vector(2.0, 0.0), 20);
    filter.rebase();
    filter.predict(0.1);
    const auto plausible = [&](double forward, double turn) {
        return filter.is_plausible(motion_of(vector(forward, turn)), kSharp, 0.1);
    };
    CHECK(plausible(0.2, 0.0));
    CHECK(plausible(0.15, 0.0));  // 5 m/s^2
    CHECK(plausible(0.2, 0.05));
    CHECK_FALSE(plausible(0.9, 0.0));
    CHECK_FALSE(plausible(-0.5, 0.0));
    CHECK_FALSE(plausible(0.2, 0.6));
}
