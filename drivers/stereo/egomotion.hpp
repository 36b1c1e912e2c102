// The motion of a stereo camera between two moments, by points that it saw in both (paper 3.2).
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "drivers/stereo/rigid_motion.hpp"
#include "drivers/stereo/stereo_calibration.hpp"

namespace crspf {

/// Where both cameras of a rectified pair see a point. [px]
struct StereoPoint {
    double left_u_px = 0.0;
    double right_u_px = 0.0;
    double v_px = 0.0;  ///< the mean of both rows, which rectified pictures have in common

    [[nodiscard]] double disparity_px() const { return left_u_px - right_u_px; }
};

/// The same point at two moments.
struct StereoMatch {
    StereoPoint before;
    StereoPoint after;
};

/// In the left camera's optical axes. [m] The disparity must be positive.
[[nodiscard]] Eigen::Vector3d point_of(const RectifiedCamera& camera, const StereoPoint& seen);
/// The other way; the point must lie ahead.
[[nodiscard]] StereoPoint seen_at(const RectifiedCamera& camera, const Eigen::Vector3d& p_left);

struct Egomotion {
    /// Optical axes of the left camera: x right, y down, z forward.
    RigidMotion P_before_after;
    /// Of the error seen from the camera after the motion: translation [m^2], rotation [rad^2].
    Matrix6 covariance = Matrix6::Zero();
    std::uint32_t inliers = 0;
    double rms_px = 0.0;  ///< of the inliers' reprojection errors
};

struct EgomotionParams {
    std::uint32_t trials = 100;  ///< of RANSAC, at most
    double inlier_px = 2.0;      ///< reprojection error of an inlier, in each of the three coordinates
    double noise_px = 0.25;      ///< standard deviation of a feature's position; the residuals may say more
    std::uint32_t inliers_min = 12;
};

/// RANSAC over three points each, its random numbers from a fixed seed; then Gauss-Newton over the inliers on the
/// reprojection error, each point weighted by what is known of its depth. Bounded time. Keeps buffers from call to
/// call.
class EgomotionSolver {
 public:
    explicit EgomotionSolver(const RectifiedCamera& camera, const EgomotionParams& params = {})
        : camera_(camera), params_(params) {}

    /// Starts at `guess`, of P_before_after. False: the points do not agree on a motion, and `out` is as it was but for
    /// its inliers.
    [[nodiscard]] bool solve(std::span<const StereoMatch> matches, const RigidMotion& guess, Egomotion& out);
    /// The same without RANSAC: by those points only that agree with `guess`, be they few.
    [[nodiscard]] bool refine(std::span<const StereoMatch> matches, const RigidMotion& guess, Egomotion& out);

    /// Of the last call, one for each match.
    [[nodiscard]] const std::vector<bool>& inliers() const { return inlier_; }

 private:
    struct Normal {
        Matrix6 H = Matrix6::Zero();
        Vector6 b = Vector6::Zero();
        double chi2 = 0.0;
        double squares_px2 = 0.0;
        std::uint32_t count = 0;
    };
    [[nodiscard]] bool fit(std::span<const StereoMatch> matches, const std::array<std::uint32_t, 3>& pick,
                           RigidMotion& P_after_before) const;
    [[nodiscard]] std::uint32_t count_inliers(std::span<const StereoMatch> matches, const RigidMotion& P_after_before,
                                              std::uint32_t to_beat) const;
    void load(std::span<const StereoMatch> matches);
    [[nodiscard]] RigidMotion search(std::span<const StereoMatch> matches, const RigidMotion& P_after_before) const;
    [[nodiscard]] bool descend(std::span<const StereoMatch> matches, RigidMotion P_after_before, Egomotion& out);
    void mark_inliers(std::span<const StereoMatch> matches, const RigidMotion& P_after_before);
    [[nodiscard]] bool is_inlier(const StereoMatch& match, std::size_t i, const RigidMotion& P_after_before) const;
    [[nodiscard]] Normal normal_equations(std::span<const StereoMatch> matches,
                                          const RigidMotion& P_after_before) const;

    RectifiedCamera camera_;
    EgomotionParams params_;
    std::vector<Eigen::Vector3d> points_;  ///< seen from the camera before
    std::vector<bool> inlier_;
};

}  // namespace crspf
