#include "core/slam/refinement.hpp"

#include <Eigen/Core>
#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <algorithm>

#include "core/base/real.hpp"

namespace crspf {
namespace {

using Matrix2 = Eigen::Matrix<double, 2, 2>;
using Matrix3 = Eigen::Matrix<double, 3, 3>;
using Vector2 = Eigen::Matrix<double, 2, 1>;
using Vector3 = Eigen::Matrix<double, 3, 1>;

// Keeps the matrix regular where the field is flat; far below any information that matters.
constexpr double kRegular = 1e-9;

Matrix3 as_matrix(const Covariance3& c) {
    Matrix3 m;
    m << c.xx, c.xy, c.xt, c.xy, c.yy, c.yt, c.xt, c.yt, c.tt;
    return m;
}

Vector3 newton_step(const MatchObjective& objective, const MatchObjective::Linearized& at, const Pose2& P) {
    const double curvature = objective.pull_curvature(P);
    Matrix3 h = as_matrix(at.information) + kRegular * Matrix3::Identity();
    h(0, 0) += curvature;
    h(1, 1) += curvature;
    const Vector3 slope{at.gradient[0] - curvature * (P.x_m - objective.observed().x_m),
                        at.gradient[1] - curvature * (P.y_m - objective.observed().y_m), at.gradient[2]};
    return h.inverse() * slope;
}

}  // namespace

Refined refine(const MatchObjective& objective, const Pose2& start) {
    constexpr std::uint32_t kPasses = 6;
    constexpr double kLongest_m = 0.05;
    constexpr double kLongest_rad = 0.02;
    constexpr double kConverged = 0.01;  // of the longest step: half a millimetre, 0.2 mrad
    Refined best{.P_map_base = start, .at = objective.linearize(start), .evaluations = 1};
    double score = best.at.match - objective.pull(start);
    double damping = 0.5;  // full steps overshoot: the match bends more than its slopes say
    while (best.evaluations < kPasses) {
        const Pose2& P = best.P_map_base;
        const Vector3 step = damping * newton_step(objective, best.at, P);
        const double length = std::max(std::max(absolute(step(0)), absolute(step(1))) / kLongest_m,
                                       absolute(step(2)) / kLongest_rad);
        const double shrink = length > 1.0 ? 1.0 / length : 1.0;
        const Pose2 next{.x_m = P.x_m + shrink * step(0),
                         .y_m = P.y_m + shrink * step(1),
                         .theta_rad = wrap_angle(P.theta_rad + shrink * step(2))};
        const MatchObjective::Linearized there = objective.linearize(next);
        ++best.evaluations;
        const double next_score = there.match - objective.pull(next);
        if (next_score > score) {
            best.P_map_base = next;
            score = next_score;
            best.at = there;
        } else {
            damping *= 0.5;
        }
        if (length < kConverged) {
            break;
        }
    }
    return best;
}

MatchShape match_shape(const MatchObjective& objective, const Covariance3& information_of_match, double resolution_m,
                       double degenerate_below) {
    const Matrix3 h = as_matrix(information_of_match);
    // Information about the position when the heading is free: the Schur complement.
    Matrix2 position = h.topLeftCorner<2, 2>();
    const Vector2 with_heading = h.topRightCorner<2, 1>();
    position -= with_heading * with_heading.transpose() / (h(2, 2) + kRegular);
    const Eigen::SelfAdjointEigenSolver<Matrix2> solver(position);
    const double weakest = std::max(solver.eigenvalues()(0), 0.0);
    const double strongest = std::max(solver.eigenvalues()(1), 0.0);
    MatchShape shape;
    shape.weakest_x = solver.eigenvectors()(0, 0);
    shape.weakest_y = solver.eigenvectors()(1, 0);
    shape.weakest_ratio = strongest > 0.0 ? weakest / strongest : 0.0;
    shape.degenerate = shape.weakest_ratio < degenerate_below;

    // Scale: the direction that the scan sees best is known as well as independent rays on a wall allow, each to the
    // block's half width. Neighbouring rays share the map's error, so one in four counts as independent.
    constexpr double kIndependent = 0.25;
    const double rays = kIndependent * static_cast<double>(objective.rays());
    const double ray_variance = square(kBlockReach * resolution_m);
    Matrix3 information = strongest > 0.0 ? Matrix3(h * (rays / ray_variance / strongest)) : Matrix3(Matrix3::Zero());
    const MotionPrior& prior = objective.prior();
    const Vector3 odometry{1.0 / square(prior.translation_stddev_m), 1.0 / square(prior.translation_stddev_m),
                           1.0 / square(prior.rotation_stddev_rad)};
    information.diagonal() += odometry;
    const Matrix3 covariance = information.inverse();
    shape.covariance = {.xx = covariance(0, 0),
                        .xy = covariance(0, 1),
                        .yy = covariance(1, 1),
                        .xt = covariance(0, 2),
                        .yt = covariance(1, 2),
                        .tt = covariance(2, 2)};
    return shape;
}

Pose2 keep_odometry_along(const MatchShape& shape, const Pose2& found, const Pose2& observed) {
    const double moved_m =
        (found.x_m - observed.x_m) * shape.weakest_x + (found.y_m - observed.y_m) * shape.weakest_y;
    return {.x_m = found.x_m - moved_m * shape.weakest_x,
            .y_m = found.y_m - moved_m * shape.weakest_y,
            .theta_rad = found.theta_rad};
}

}  // namespace crspf
