// Poses of the plane. Frames as in REP-105; P_a_b is the pose of frame b in frame a, so P_a_c = P_a_b * P_b_c.
#pragma once

#include "core/base/trig.hpp"

namespace crspf {

/// A rigid transform of the plane: x forward, y left, heading counter-clockwise (REP-103).
struct Pose2 {
    double x_m = 0.0;        ///< [m]
    double y_m = 0.0;        ///< [m]
    double theta_rad = 0.0;  ///< [rad] kept in [-pi, pi) by the operations below

    friend bool operator==(const Pose2&, const Pose2&) = default;
};

/// Composition: first `a`, then `b` seen from `a`.
[[nodiscard]] inline Pose2 operator*(const Pose2& a, const Pose2& b) {
    const SinCos r = sin_cos(a.theta_rad);
    return {.x_m = a.x_m + (r.cos * b.x_m - r.sin * b.y_m),
            .y_m = a.y_m + (r.sin * b.x_m + r.cos * b.y_m),
            .theta_rad = wrap_angle(a.theta_rad + b.theta_rad)};
}

[[nodiscard]] inline Pose2 inverse(const Pose2& p) {
    const SinCos r = sin_cos(p.theta_rad);
    return {.x_m = -(r.cos * p.x_m + r.sin * p.y_m),
            .y_m = -(r.cos * p.y_m - r.sin * p.x_m),
            .theta_rad = wrap_angle(-p.theta_rad)};
}

/// The pose at the fraction `u` in [0, 1] of the way from `a` to `b`: position and heading linear, by the short turn.
[[nodiscard]] inline Pose2 interpolate(const Pose2& a, const Pose2& b, double u) {
    return {.x_m = a.x_m + u * (b.x_m - a.x_m),
            .y_m = a.y_m + u * (b.y_m - a.y_m),
            .theta_rad = wrap_angle(a.theta_rad + u * wrap_angle(b.theta_rad - a.theta_rad))};
}

/// Covariance of a Pose2, symmetric; the order is x, y, theta.
struct Covariance3 {
    double xx = 0.0;  ///< [m^2]
    double xy = 0.0;  ///< [m^2]
    double yy = 0.0;  ///< [m^2]
    double xt = 0.0;  ///< [m rad]
    double yt = 0.0;  ///< [m rad]
    double tt = 0.0;  ///< [rad^2]

    friend bool operator==(const Covariance3&, const Covariance3&) = default;
};

}  // namespace crspf
