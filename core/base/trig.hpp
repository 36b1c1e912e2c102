// Trigonometry that gives the same bits everywhere: only +, -, *, / and sqrt, which IEEE 754 rounds correctly.
// libm's sin and cos may differ in the last bit between libraries, compilers and processors; a map built on them
// would not be reproducible. The build turns FMA contraction off for the same reason (see core/DESIGN.md).
#pragma once

namespace crspf {

inline constexpr double kPi = 3.14159265358979323846;

/// Sine and cosine of one angle.
struct SinCos {
    double sin;
    double cos;
};

/// Sine and cosine. [rad] any finite angle up to +-1e6 within 1e-12 of the true value; beyond that it degrades as the
/// reduction does. A non-finite angle gives sin 0, cos 1. Wait-free, constant time.
[[nodiscard]] SinCos sin_cos(double angle_rad);

/// atan2 within 1e-12 of the true value; atan2(0, 0) is 0. [rad] in [-pi, pi]. Wait-free, constant time.
[[nodiscard]] double arc_tan2(double y, double x);

/// The same angle in [-pi, pi). A non-finite angle gives 0.
[[nodiscard]] double wrap_angle(double angle_rad);

constexpr double radians(double degrees) {
    return degrees * (kPi / 180.0);
}
constexpr double degrees(double radians) {
    return radians * (180.0 / kPi);
}

}  // namespace crspf
