#include "drivers/stereo/motion_filter.hpp"

#include <Eigen/Cholesky>

#include "core/base/real.hpp"

namespace crspf {

namespace {

// How the velocity of a vehicle wanders: by 1 m/s and 0.5 rad/s within a second.
constexpr double kSpeedWalk = 1.0;  // [(m/s)^2/s]
constexpr double kTurnWalk = 0.25;  // [(rad/s)^2/s]
// A vehicle whose motion is not known.
constexpr double kSpeedStddev_mps = 15.0;
constexpr double kTurnStddev_radps = 2.0;
// No wheel accelerates a vehicle by more, nor does a bump turn it faster.
constexpr double kAcceleration = 10.0;  // [m/s^2]
constexpr double kTurning = 20.0;       // [rad/s^2]
constexpr double kSigmas = 3.0;

Vector6 both(double linear, double angular) {
    Vector6 v;
    v << linear, linear, linear, angular, angular, angular;
    return v;
}

}  // namespace

void MotionFilter::forget_velocity() {
    velocity_.setZero();
    covariance_.topRightCorner<6, 6>().setZero();
    covariance_.bottomLeftCorner<6, 6>().setZero();
    covariance_.bottomRightCorner<6, 6>() = both(square(kSpeedStddev_mps), square(kTurnStddev_radps)).asDiagonal();
}

void MotionFilter::predict(double seconds) {
    const RigidMotion step = motion_of(velocity_ * seconds);
    P_reference_camera_ = P_reference_camera_ * step;
    Covariance F = Covariance::Identity();
    F.topLeftCorner<6, 6>() = adjoint(step.inverse());
    F.topRightCorner<6, 6>() = seconds * Matrix6::Identity();
    covariance_ = F * covariance_ * F.transpose();
    // The walk itself, integrated over the time.
    const Vector6 walk = both(kSpeedWalk, kTurnWalk);
    const auto add = [&](int row, int column, double factor) {
        for (int i = 0; i < 6; ++i) {
            covariance_(row + i, column + i) += factor * walk(i);
        }
    };
    add(0, 0, seconds * seconds * seconds / 3.0);
    add(0, 6, seconds * seconds / 2.0);
    add(6, 0, seconds * seconds / 2.0);
    add(6, 6, seconds);
}

bool MotionFilter::is_plausible(const RigidMotion& P_reference_camera, const Matrix6& covariance,
                                double seconds) const {
    const Vector6 off = vector_of(P_reference_camera_.inverse() * P_reference_camera);
    const Covariance& P = covariance_;
    for (int i = 0; i < 6; ++i) {
        // What was not known of place and velocity before counts, what may have changed since is bounded by physics.
        const double by_force = (i < 3 ? kAcceleration : kTurning) * seconds * seconds;
        const double known = square_root(P(i, i) + covariance(i, i));
        if (absolute(off(i)) > by_force + kSigmas * known) {
            return false;
        }
    }
    return true;
}

void MotionFilter::update(const RigidMotion& P_reference_camera, const Matrix6& covariance) {
    const Vector6 off = vector_of(P_reference_camera_.inverse() * P_reference_camera);
    const Matrix6 S = covariance_.topLeftCorner<6, 6>() + covariance;
    const Eigen::Matrix<double, 12, 6> K =
        S.ldlt().solve(covariance_.topRows<6>()).transpose();  // P H^T S^-1, both symmetric
    const Eigen::Matrix<double, 12, 1> correction = K * off;
    P_reference_camera_ = P_reference_camera_ * motion_of(correction.head<6>());
    velocity_ += correction.tail<6>();
    // Joseph's form: symmetric and positive whatever the rounding.
    Covariance kept = Covariance::Identity();
    kept.leftCols<6>() -= K;
    covariance_ = kept * covariance_ * kept.transpose() + K * covariance * K.transpose();
}

void MotionFilter::rebase() {
    P_reference_camera_ = {};
    covariance_.topRows<6>().setZero();
    covariance_.leftCols<6>().setZero();
}

}  // namespace crspf
