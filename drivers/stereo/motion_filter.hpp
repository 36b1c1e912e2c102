// The camera's motion since a reference picture and its velocity, filtered (paper 3.2: EKF-based egomotion).
#pragma once

#include "drivers/stereo/rigid_motion.hpp"

namespace crspf {

/// An extended Kalman filter. State: P_reference_camera and the velocity in the camera's axes, which changes as a
/// random walk. The error of the pose is one seen from the camera. Constant time, no heap.
class MotionFilter {
 public:
    using Covariance = Eigen::Matrix<double, 12, 12>;

    MotionFilter() { forget_velocity(); }

    /// `seconds` pass.
    void predict(double seconds);

    /// Whether a vehicle can have come to `P_reference_camera` by now. Asked after predict().
    /// @param seconds since the last update
    [[nodiscard]] bool is_plausible(const RigidMotion& P_reference_camera, const Matrix6& covariance,
                                    double seconds) const;
    /// The pictures say where the camera is. @param covariance as Egomotion's
    void update(const RigidMotion& P_reference_camera, const Matrix6& covariance);

    /// The camera's place is the new reference.
    void rebase();
    /// It may move anyhow now.
    void forget_velocity();
    /// It is taken to stand; how well that is known stays as it is.
    void stop() { velocity_.setZero(); }

    [[nodiscard]] const RigidMotion& P_reference_camera() const { return P_reference_camera_; }
    /// [m/s], [rad/s] in the camera's optical axes
    [[nodiscard]] const Vector6& velocity() const { return velocity_; }
    /// Of the pose, as Egomotion's.
    [[nodiscard]] Matrix6 pose_covariance() const { return covariance_.topLeftCorner<6, 6>(); }

 private:
    RigidMotion P_reference_camera_;
    Vector6 velocity_ = Vector6::Zero();
    Covariance covariance_ = Covariance::Zero();
};

}  // namespace crspf
