#include "core/slam/refinement.hpp"

#include <Eigen/Core>
#include <Eigen/LU>
#include <algorithm>

#include "core/base/real.hpp"

namespace crspf {
namespace {

using Matrix3 = Eigen::Matrix<double, 3, 3>;
using Vector3 = Eigen::Matrix<double, 3, 1>;

// Keeps the matrix regular where the field is flat; far below any information that matters.
constexpr double kRegular = 1e-9;

Matrix3 as_matrix(const Covariance3& c) {
    Matrix3 m;
    m << c.xx, c.xy, c.xt, c.xy, c.yy, c.yt, c.xt, c.yt, c.tt;
    return m;
}

/// A climb's rule: the step from a pose, how much of the pull it feels, and the share of the step that is tried first.
struct Climb {
    Vector3 (*step)(const MatchObjective::Linearized& at, double curvature, const Vector3& from_observed);
    double pull_share;
    double first_share;
};

/// Least squares of what is missing to a full match. No wall matches fully, so the steps reach far: they end at the
/// bound on a step and at the share tried, and so look for the optimum in strides.
Vector3 stride(const MatchObjective::Linearized& at, double curvature, const Vector3& from_observed) {
    Matrix3 h = as_matrix(at.information) + kRegular * Matrix3::Identity();
    h(0, 0) += curvature;
    h(1, 1) += curvature;
    const Vector3 slope = Vector3{at.missing[0], at.missing[1], at.missing[2]} - curvature * from_observed;
    return h.inverse() * slope;
}

/// Newton on the match itself. A ray's field falls off evenly to both sides of its wall, so the match bends where rays
/// lie about a cell beside their walls, as they do near the optimum: by J^T J over the steepness.
Vector3 newton(const MatchObjective::Linearized& at, double curvature, const Vector3& from_observed) {
    const double steepness = std::max(at.steepness, kRegular);
    Matrix3 h = as_matrix(at.information) / steepness + kRegular * Matrix3::Identity();
    h(0, 0) += 2.0 * curvature;
    h(1, 1) += 2.0 * curvature;
    const Vector3 slope = Vector3{at.slope[0], at.slope[1], at.slope[2]} - 2.0 * curvature * from_observed;
    return h.inverse() * slope;
}

Refined climb(const Climb& rule, const MatchObjective& objective, const Pose2& start) {
    constexpr double kLongest_m = 0.1;
    constexpr double kLongest_rad = 0.04;
    constexpr double kConverged = 0.005;  // of the longest step: half a millimetre, 0.2 mrad
    Refined best{.P_map_base = start, .evaluations = 1};
    MatchObjective::Linearized at = objective.linearize(start);
    double score = at.match - rule.pull_share * objective.pull(start);
    double share = rule.first_share;
    while (best.evaluations < kClimbPasses) {
        const Pose2& P = best.P_map_base;
        const Pose2& observed = objective.observed();
        const Vector3 step = rule.step(at, rule.pull_share * objective.pull_curvature(P),
                                       {P.x_m - observed.x_m, P.y_m - observed.y_m, 0.0});
        const double length =
            std::max(std::max(absolute(step(0)), absolute(step(1))) / kLongest_m, absolute(step(2)) / kLongest_rad);
        const double bounded = share * (length > 1.0 ? 1.0 / length : 1.0);
        const Pose2 next{.x_m = P.x_m + bounded * step(0),
                         .y_m = P.y_m + bounded * step(1),
                         .theta_rad = wrap_angle(P.theta_rad + bounded * step(2))};
        const MatchObjective::Linearized there = objective.linearize(next);
        ++best.evaluations;
        const double next_score = there.match - rule.pull_share * objective.pull(next);
        if (next_score > score) {
            best.P_map_base = next;
            score = next_score;
            at = there;
        } else {
            share *= 0.5;
        }
        if (share * length < kConverged) {
            break;
        }
    }
    return best;
}

}  // namespace

Refined approach(const MatchObjective& objective, const Pose2& start) {
    return climb({.step = stride, .pull_share = 1.0, .first_share = 0.5}, objective, start);
}

Refined refine(const MatchObjective& objective, const Pose2& start) {
    // The pull guards the search against jumps. Between the particles' best and the top of the same hill there is
    // nothing to jump to, and the full pull would keep the odometry's scale error: three parts in ten remain, so that a
    // direction which few rays see does not slide.
    constexpr double kPullShare = 0.3;
    return climb({.step = newton, .pull_share = kPullShare, .first_share = 1.0}, objective, start);
}

MatchShape match_shape(const MatchObjective& objective, const Pose2& P_map_base, double resolution_m,
                       double degenerate_below) {
    // How far the match drops a little to either side, on the mean: along x, y, and both diagonals. A quadratic drop is
    // a + b cos(2 phi) + c sin(2 phi) over the direction phi, which gives the direction where it is least.
    const double step_m = (kBlockReach + 0.5) * resolution_m;
    const double here = objective.match(P_map_base);
    const auto drop = [&](double dx_m, double dy_m, double turn_rad) {
        const auto aside = [&](double sign) {
            return objective.match({.x_m = P_map_base.x_m + sign * dx_m,
                                    .y_m = P_map_base.y_m + sign * dy_m,
                                    .theta_rad = wrap_angle(P_map_base.theta_rad + sign * turn_rad)});
        };
        return here - 0.5 * (aside(1.0) + aside(-1.0));
    };
    constexpr double kDiagonal = 0.70710678118654752440;
    const double by_x = drop(step_m, 0.0, 0.0);
    const double by_y = drop(0.0, step_m, 0.0);
    const double by_rising = drop(kDiagonal * step_m, kDiagonal * step_m, 0.0);
    const double by_falling = drop(-kDiagonal * step_m, kDiagonal * step_m, 0.0);
    const SinCos along = sin_cos(0.5 * arc_tan2(by_falling - by_rising, by_y - by_x));
    // Far from the optimum the drop is no quadratic: the sizes are measured, not taken from the fit.
    const double drop_along = drop(step_m * along.cos, step_m * along.sin, 0.0);
    const double weakest = std::max(drop_along, 0.0);
    const double strongest = std::max(drop(-step_m * along.sin, step_m * along.cos, 0.0), 0.0);

    MatchShape shape;
    shape.weakest_x = along.cos;
    shape.weakest_y = along.sin;
    shape.weakest_ratio = strongest > 0.0 ? std::min(weakest / strongest, 1.0) : 0.0;
    // Flat along and a clear ridge across. Where the match rises to the side the pose is no optimum, and that is
    // another matter than a direction which the scan does not see.
    constexpr double kClearRidge = 0.3;
    shape.degenerate = strongest > kClearRidge * here && absolute(drop_along) < degenerate_below * strongest;

    // If every ray lay on a wall across the direction, the block sums 9 of (10) on the wall would fall to 5 or 0: this
    // share of the match. What falls tells the share of rays that see the direction. Each is good to the block's half
    // width; neighbours share the map's error, so one in four counts as independent.
    constexpr double kFullDrop = (9.0 - 0.5 * (5.0 + 0.0)) / 9.0;
    constexpr double kIndependent = 0.25;
    const double rays = kIndependent * static_cast<double>(objective.rays());
    const auto precision = [&](double dropped) {
        const double share = here > 0.0 ? std::max(dropped, 0.0) / (kFullDrop * here) : 0.0;
        return rays * share / square(kBlockReach * resolution_m);
    };
    const MotionPrior& prior = objective.prior();
    const double odometry = 1.0 / square(prior.translation_stddev_m);
    const double variance_along = 1.0 / (precision(weakest) + odometry);
    const double variance_across = 1.0 / (precision(strongest) + odometry);
    const double lever_m = std::max(objective.rms_range_m(), resolution_m);
    const double turn_precision = square(lever_m) * precision(drop(0.0, 0.0, step_m / lever_m));
    const double difference = variance_along - variance_across;
    shape.covariance = {.xx = variance_across + difference * square(along.cos),
                        .xy = difference * along.cos * along.sin,
                        .yy = variance_across + difference * square(along.sin),
                        .xt = 0.0,
                        .yt = 0.0,
                        .tt = 1.0 / (turn_precision + 1.0 / square(prior.rotation_stddev_rad))};
    return shape;
}

Pose2 keep_odometry_along(const MatchShape& shape, const Pose2& found, const Pose2& observed) {
    const double moved_m = (found.x_m - observed.x_m) * shape.weakest_x + (found.y_m - observed.y_m) * shape.weakest_y;
    return {.x_m = found.x_m - moved_m * shape.weakest_x,
            .y_m = found.y_m - moved_m * shape.weakest_y,
            .theta_rad = found.theta_rad};
}

}  // namespace crspf
