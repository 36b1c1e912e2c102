// Motions in space, with the few operations that stereo odometry needs.
#pragma once

#include <Eigen/Core>
#include <Eigen/LU>

namespace crspf {

using Vector6 = Eigen::Matrix<double, 6, 1>;  ///< translation [m], then rotation [rad]
using Matrix6 = Eigen::Matrix<double, 6, 6>;

/// [v]x: [v]x w is the cross product.
[[nodiscard]] inline Eigen::Matrix3d cross_matrix(const Eigen::Vector3d& v) {
    Eigen::Matrix3d m;
    m << 0.0, -v.z(), v.y(), v.z(), 0.0, -v.x(), -v.y(), v.x(), 0.0;
    return m;
}

/// P_a_b: a point of b, seen from a, is R p + t.
struct RigidMotion {
    Eigen::Matrix3d R = Eigen::Matrix3d::Identity();
    Eigen::Vector3d t = Eigen::Vector3d::Zero();  ///< [m]

    friend RigidMotion operator*(const RigidMotion& a, const RigidMotion& b) { return {a.R * b.R, a.R * b.t + a.t}; }
    friend Eigen::Vector3d operator*(const RigidMotion& a, const Eigen::Vector3d& p) { return a.R * p + a.t; }
    [[nodiscard]] RigidMotion inverse() const { return {R.transpose(), -(R.transpose() * t)}; }
};

// A small motion as six numbers. The rotation is its Cayley vector, 2 tan(angle / 2) along the axis: to third order the
// rotation vector, and without a sine.

[[nodiscard]] inline RigidMotion motion_of(const Vector6& v) {
    const Eigen::Vector3d w = v.tail<3>();
    const Eigen::Matrix3d W = cross_matrix(w);
    return {Eigen::Matrix3d::Identity() + (W + 0.5 * W * W) * (4.0 / (4.0 + w.squaredNorm())), v.head<3>()};
}

/// The other way. A rotation by half a turn has no Cayley vector: what comes out is large then.
[[nodiscard]] inline Vector6 vector_of(const RigidMotion& m) {
    Vector6 v;
    v.head<3>() = m.t;
    const double sum = 1.0 + m.R.trace();
    v.tail<3>() = Eigen::Vector3d(m.R(2, 1) - m.R(1, 2), m.R(0, 2) - m.R(2, 0), m.R(1, 0) - m.R(0, 1)) *
                  (2.0 / (sum > 1e-6 ? sum : 1e-6));
    return v;
}

/// How a small motion before `m`, seen from behind it, looks: exp(v) m = m exp(adjoint(m^-1) v).
[[nodiscard]] inline Matrix6 adjoint(const RigidMotion& m) {
    Matrix6 a = Matrix6::Zero();
    a.topLeftCorner<3, 3>() = m.R;
    a.topRightCorner<3, 3>() = cross_matrix(m.t) * m.R;
    a.bottomRightCorner<3, 3>() = m.R;
    return a;
}

}  // namespace crspf
