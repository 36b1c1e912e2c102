#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <limits>

#include "core/base/rng.hpp"
#include "core/base/trig.hpp"
#include "tests/unit/core/synthetic.hpp"

using namespace crspf;

namespace {

constexpr double kTolerance = 1e-12;
constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

double worst_of(double angle_rad) {
    const SinCos r = sin_cos(angle_rad);
    return std::max(std::abs(r.sin - std::sin(angle_rad)), std::abs(r.cos - std::cos(angle_rad)));
}

}  // namespace

TEST_CASE("sine and cosine are libm's to 1e-12") {
    double worst = 0.0;
    SECTION("a dense sweep over two turns") {
        for (int i = -500000; i <= 500000; ++i) {
            worst = std::max(worst, worst_of(i * 2.6e-5));
        }
    }
    SECTION("both sides of every quadrant's border") {
        for (int k = -4000; k <= 4000; ++k) {
            for (const double quarter : {0.5, 1.0}) {
                const double border = k * quarter * kPi / 2.0;
                for (const double angle :
                     {std::nextafter(border, -kInfinity), border, std::nextafter(border, kInfinity)}) {
                    worst = std::max(worst, worst_of(angle));
                }
            }
        }
    }
    SECTION("anywhere up to a million radians") {
        Rng rng(1);
        for (int i = 0; i < 200000; ++i) {
            worst = std::max(worst, worst_of(1e6 * rng.symmetric()));
        }
    }
    CHECK(worst < kTolerance);
}

TEST_CASE("angles that are none are forward") {
    for (const double angle : {kNan, kInfinity, -kInfinity, 1e300, -1e300}) {
        CHECK(sin_cos(angle).sin == 0.0);
        CHECK(sin_cos(angle).cos == 1.0);
        CHECK(wrap_angle(angle) == 0.0);
    }
}

TEST_CASE("atan2 is libm's to 1e-12") {
    double worst = 0.0;
    SECTION("all round, near and far") {
        for (const double radius : {1e-200, 1e-9, 1.0, 37.5, 1e150}) {
            for (int i = -100000; i < 100000; ++i) {
                const double angle = (i + 0.5) * (kPi / 100000.0);
                const double y = radius * std::sin(angle);
                const double x = radius * std::cos(angle);
                worst = std::max(worst, std::abs(arc_tan2(y, x) - std::atan2(y, x)));
            }
        }
    }
    SECTION("the axes and the borders between its series") {
        for (const double tangent :
             {0.0, 0.19891236737965800691, 0.41421356237309504880, 0.66817863791929891999, 1.0}) {
            for (const double t : {std::nextafter(tangent, -1.0), tangent, std::nextafter(tangent, 2.0)}) {
                for (const double sign_x : {-1.0, 1.0}) {
                    for (const double sign_y : {-1.0, 1.0}) {
                        // "+ 0.0": libm tells -0 from 0 behind the robot, the core does not.
                        const double a = sign_y * t + 0.0;
                        const double b = sign_x + 0.0;
                        worst = std::max(worst, std::abs(arc_tan2(a, b) - std::atan2(a, b)));
                        worst = std::max(worst, std::abs(arc_tan2(b, a) - std::atan2(b, a)));
                    }
                }
            }
        }
    }
    CHECK(worst < kTolerance);
    CHECK(arc_tan2(0.0, 0.0) == 0.0);
}

TEST_CASE("a wrapped angle is the same angle from -pi to below pi") {
    SECTION("the edges") {
        CHECK(wrap_angle(kPi) == -kPi);
        CHECK(wrap_angle(-kPi) == -kPi);
        CHECK(wrap_angle(0.0) == 0.0);
        CHECK(wrap_angle(std::nextafter(kPi, 0.0)) == std::nextafter(kPi, 0.0));
        CHECK(wrap_angle(3.0 * kPi) == Approx(-kPi));
        CHECK(wrap_angle(2.0 * kPi) == Approx(0.0).margin(1e-15));
    }
    SECTION("just past the edges it stays inside") {
        for (int k = -200; k <= 200; ++k) {
            const double border = k * kPi;
            for (const double angle : {std::nextafter(border, -kInfinity), border, std::nextafter(border, kInfinity)}) {
                const double wrapped = wrap_angle(angle);
                CAPTURE(k, angle, wrapped);
                REQUIRE(wrapped >= -kPi);
                REQUIRE(wrapped < kPi);
            }
        }
    }
    SECTION("whole turns change nothing") {
        Rng rng(2);
        for (int i = 0; i < 100000; ++i) {
            const double angle = 1000.0 * rng.symmetric();
            const double wrapped = wrap_angle(angle);
            const double turns = (angle - wrapped) / (2.0 * kPi);
            CAPTURE(angle, wrapped);
            REQUIRE(wrapped >= -kPi);
            REQUIRE(wrapped < kPi);
            REQUIRE(std::abs(turns - std::round(turns)) < 1e-12);
        }
    }
    SECTION("the largest angle that counts") {
        CHECK(wrap_angle(1e9) >= -kPi);
        CHECK(wrap_angle(1e9) < kPi);
        CHECK(std::sin(wrap_angle(1e9)) == Approx(std::sin(1e9)).margin(1e-6));
    }
}
