#include "core/base/trig.hpp"

#include <cstdint>

namespace crspf {
namespace {

// Beyond this no sensor's angle makes sense, and the conversion to an integer would overflow.
constexpr double kLargestAngle_rad = 1e9;

constexpr bool usable(double angle_rad) {
    return angle_rad >= -kLargestAngle_rad && angle_rad <= kLargestAngle_rad;  // false for NaN
}

// Taylor series on [-pi/4, pi/4]: the first term left out is below 1e-16.
constexpr double sin_kernel(double r) {
    const double z = r * r;
    double p = -1.0 / 1307674368000.0;
    p = p * z + 1.0 / 6227020800.0;
    p = p * z - 1.0 / 39916800.0;
    p = p * z + 1.0 / 362880.0;
    p = p * z - 1.0 / 5040.0;
    p = p * z + 1.0 / 120.0;
    p = p * z - 1.0 / 6.0;
    return r + r * z * p;
}

constexpr double cos_kernel(double r) {
    const double z = r * r;
    double p = 1.0 / 20922789888000.0;
    p = p * z - 1.0 / 87178291200.0;
    p = p * z + 1.0 / 479001600.0;
    p = p * z - 1.0 / 3628800.0;
    p = p * z + 1.0 / 40320.0;
    p = p * z - 1.0 / 720.0;
    p = p * z + 1.0 / 24.0;
    p = p * z - 0.5;
    return 1.0 + z * p;
}

// atan on [0, tan(pi/16)] by its alternating series.
constexpr double atan_kernel(double t) {
    const double z = t * t;
    double p = 0.0;
    for (int k = 10; k >= 0; --k) {
        p = 1.0 / static_cast<double>(2 * k + 1) - z * p;
    }
    return t * p;
}

constexpr double kTanPi16 = 0.19891236737965800691;
constexpr double kTanPi8 = 0.41421356237309504880;

// atan on [0, 1]: rotate by pi/8 or by pi/4 until the series converges fast.
constexpr double atan_unit(double t) {
    if (t <= kTanPi16) {
        return atan_kernel(t);
    }
    constexpr double kTan3Pi16 = 0.66817863791929891999;
    if (t <= kTan3Pi16) {
        const double r = (t - kTanPi8) / (1.0 + t * kTanPi8);
        return kPi / 8.0 + (r < 0.0 ? -atan_kernel(-r) : atan_kernel(r));
    }
    return kPi / 4.0 - atan_kernel((1.0 - t) / (1.0 + t));
}

}  // namespace

SinCos sin_cos(double angle_rad) {
    if (!usable(angle_rad)) {
        return {.sin = 0.0, .cos = 1.0};
    }
    // Cody-Waite: pi/2 in two parts, so that the reduction keeps its digits.
    constexpr double kHalfPiHigh = 1.57079632673412561417e+00;
    constexpr double kHalfPiLow = 6.07710050650619224932e-11;
    const double turns = angle_rad * (2.0 / kPi);
    const auto quadrant = static_cast<std::int64_t>(turns < 0.0 ? turns - 0.5 : turns + 0.5);
    const auto q = static_cast<double>(quadrant);
    const double r = (angle_rad - q * kHalfPiHigh) - q * kHalfPiLow;
    const double s = sin_kernel(r);
    const double c = cos_kernel(r);
    switch (static_cast<std::uint64_t>(quadrant) & 3U) {
        case 0: return {.sin = s, .cos = c};
        case 1: return {.sin = c, .cos = -s};
        case 2: return {.sin = -s, .cos = -c};
        default: return {.sin = -c, .cos = s};
    }
}

double arc_tan2(double y, double x) {
    const double ax = x < 0.0 ? -x : x;
    const double ay = y < 0.0 ? -y : y;
    if (!(ax > 0.0) && !(ay > 0.0)) {
        return 0.0;
    }
    double angle = ay <= ax ? atan_unit(ay / ax) : kPi / 2.0 - atan_unit(ax / ay);
    if (x < 0.0) {
        angle = kPi - angle;
    }
    return y < 0.0 ? -angle : angle;
}

double wrap_angle(double angle_rad) {
    if (!usable(angle_rad)) {
        return 0.0;
    }
    if (angle_rad >= -kPi && angle_rad < kPi) {
        return angle_rad;
    }
    const double turns = (angle_rad + kPi) / (2.0 * kPi);
    auto whole = static_cast<double>(static_cast<std::int64_t>(turns));
    if (whole > turns) {
        whole -= 1.0;
    }
    const double wrapped = angle_rad - whole * (2.0 * kPi);
    return wrapped >= kPi ? wrapped - 2.0 * kPi : (wrapped < -kPi ? wrapped + 2.0 * kPi : wrapped);
}

}  // namespace crspf
