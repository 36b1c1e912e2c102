#include "drivers/stereo/egomotion.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <array>

#include "core/base/real.hpp"
#include "core/base/rng.hpp"

namespace crspf {

namespace {

using Matrix36 = Eigen::Matrix<double, 3, 6>;

constexpr double kNearest_m = 0.05;  // what lies nearer, or behind, is not seen
constexpr int kRounds = 20;
constexpr int kRoundsOfThree = 8;
constexpr double kSettled = 1e-8;
// Residuals beyond this many standard deviations pull no harder (Huber).
constexpr double kHuber = 1.5;
// Points that almost lie on a line, or all far away, tell no motion.
constexpr double kPivotMin = 1e-12;

/// Of (left u, v, right u) by the point's place. [px/m]
Eigen::Matrix3d projection_slopes(const RectifiedCamera& camera, const Eigen::Vector3d& p) {
    const double s = camera.focal_px / p.z();
    const double sx = s / p.z();
    Eigen::Matrix3d J;
    J << s, 0.0, -sx * p.x(),  //
        0.0, s, -sx * p.y(),   //
        s, 0.0, -sx * (p.x() - camera.baseline_m);
    return J;
}

/// Of the point's place by (left u, v, right u). [m/px]
Eigen::Matrix3d point_slopes(const RectifiedCamera& camera, const Eigen::Vector3d& p) {
    const double per_px = p.z() / camera.focal_px;
    const double by_disparity = per_px / camera.baseline_m;
    Eigen::Matrix3d J = Eigen::Matrix3d::Zero();
    J.col(0) = -by_disparity * p;
    J.col(2) = by_disparity * p;
    J(0, 0) += per_px;
    J(1, 1) += per_px;
    return J;
}

Eigen::Vector3d coordinates(const StereoPoint& p) {
    return {p.left_u_px, p.v_px, p.right_u_px};
}

bool is_solvable(const Eigen::LDLT<Matrix6>& ldlt) {
    return ldlt.vectorD().minCoeff() > kPivotMin * ldlt.vectorD().maxCoeff();
}

/// Of a hypothesis that is right with so much chance each.
std::uint32_t trials_for(double chance, std::uint32_t at_most) {
    constexpr double kMissed = 1e-3;
    double missed = 1.0;
    std::uint32_t trials = 0;
    while (missed > kMissed && trials < at_most) {
        missed *= 1.0 - chance;
        ++trials;
    }
    return trials;
}

Matrix36 motion_slopes(const RectifiedCamera& camera, const Eigen::Vector3d& p) {
    const Eigen::Matrix3d by_place = projection_slopes(camera, p);
    Matrix36 J;
    J << by_place, -by_place * cross_matrix(p);
    return J;
}

}  // namespace

Eigen::Vector3d point_of(const RectifiedCamera& camera, const StereoPoint& seen) {
    const double per_px = camera.baseline_m / seen.disparity_px();
    return {(seen.left_u_px - camera.cx_px) * per_px, (seen.v_px - camera.cy_px) * per_px, camera.focal_px * per_px};
}

StereoPoint seen_at(const RectifiedCamera& camera, const Eigen::Vector3d& p_left) {
    const double s = camera.focal_px / p_left.z();
    return {.left_u_px = camera.cx_px + s * p_left.x(),
            .right_u_px = camera.cx_px + s * (p_left.x() - camera.baseline_m),
            .v_px = camera.cy_px + s * p_left.y()};
}

bool EgomotionSolver::is_inlier(const StereoMatch& match, std::size_t i, const RigidMotion& P_after_before) const {
    const Eigen::Vector3d p = P_after_before * points_[i];
    if (p.z() < kNearest_m) {
        return false;
    }
    const Eigen::Vector3d rest = coordinates(match.after) - coordinates(seen_at(camera_, p));
    return absolute(rest.x()) < params_.inlier_px && absolute(rest.y()) < params_.inlier_px &&
           absolute(rest.z()) < params_.inlier_px;
}

std::uint32_t EgomotionSolver::count_inliers(std::span<const StereoMatch> matches, const RigidMotion& P_after_before,
                                             std::uint32_t to_beat) const {
    std::uint32_t count = 0;
    for (std::size_t i = 0; i < matches.size() && count + (matches.size() - i) > to_beat; ++i) {
        count += is_inlier(matches[i], i, P_after_before) ? 1U : 0U;
    }
    return count;
}

void EgomotionSolver::mark_inliers(std::span<const StereoMatch> matches, const RigidMotion& P_after_before) {
    for (std::size_t i = 0; i < matches.size(); ++i) {
        inlier_[i] = is_inlier(matches[i], i, P_after_before);
    }
}

bool EgomotionSolver::fit(std::span<const StereoMatch> matches, const std::array<std::uint32_t, 3>& pick,
                          RigidMotion& P_after_before) const {
    for (int round = 0; round < kRoundsOfThree; ++round) {
        Matrix6 H = Matrix6::Zero();
        Vector6 b = Vector6::Zero();
        for (const std::uint32_t i : pick) {
            const Eigen::Vector3d p = P_after_before * points_[i];
            if (p.z() < kNearest_m) {
                return false;
            }
            const Matrix36 J = motion_slopes(camera_, p);
            H += J.transpose() * J;
            b += J.transpose() * (coordinates(matches[i].after) - coordinates(seen_at(camera_, p)));
        }
        const Eigen::LDLT<Matrix6> ldlt(H);
        if (!is_solvable(ldlt)) {
            return false;
        }
        const Vector6 step = ldlt.solve(b);
        P_after_before = motion_of(step) * P_after_before;
        constexpr double kCoarse = 1e-4;
        if (step.squaredNorm() < square(kCoarse)) {
            break;
        }
    }
    return true;
}

EgomotionSolver::Normal EgomotionSolver::normal_equations(std::span<const StereoMatch> matches,
                                                          const RigidMotion& P_after_before) const {
    // A row is seen twice.
    const Eigen::Vector3d variances = square(params_.noise_px) * Eigen::Vector3d(1.0, 0.5, 1.0);
    Normal n;
    for (std::size_t i = 0; i < matches.size(); ++i) {
        const Eigen::Vector3d p = P_after_before * points_[i];
        if (!inlier_[i] || p.z() < kNearest_m) {
            continue;
        }
        const Eigen::Vector3d rest = coordinates(matches[i].after) - coordinates(seen_at(camera_, p));
        const Eigen::Matrix3d by_place = projection_slopes(camera_, p);
        const Eigen::Matrix3d carried = by_place * P_after_before.R * point_slopes(camera_, points_[i]);
        Eigen::Matrix3d S = carried * variances.asDiagonal() * carried.transpose();
        S.diagonal() += variances;
        const Eigen::Matrix3d weight = S.inverse();
        const double squared = rest.dot(weight * rest);
        const double pull = squared > square(kHuber) ? kHuber / square_root(squared) : 1.0;
        Matrix36 J;
        J << by_place, -by_place * cross_matrix(p);
        const Eigen::Matrix<double, 6, 3> weighted = J.transpose() * (pull * weight);
        n.H += weighted * J;
        n.b += weighted * rest;
        n.chi2 += pull * squared;
        n.squares_px2 += rest.squaredNorm();
        ++n.count;
    }
    return n;
}

void EgomotionSolver::load(std::span<const StereoMatch> matches) {
    points_.clear();
    for (const StereoMatch& match : matches) {
        points_.push_back(point_of(camera_, match.before));
    }
    inlier_.assign(matches.size(), false);
}

bool EgomotionSolver::solve(std::span<const StereoMatch> matches, const RigidMotion& guess, Egomotion& out) {
    load(matches);
    out.inliers = 0;
    return matches.size() >= params_.inliers_min && descend(matches, search(matches, guess.inverse()), out);
}

bool EgomotionSolver::refine(std::span<const StereoMatch> matches, const RigidMotion& guess, Egomotion& out) {
    load(matches);
    out.inliers = 0;
    return descend(matches, guess.inverse(), out);
}

RigidMotion EgomotionSolver::search(std::span<const StereoMatch> matches, const RigidMotion& P_after_before) const {
    const auto size = static_cast<std::uint32_t>(matches.size());
    RigidMotion best = P_after_before;
    std::uint32_t most = count_inliers(matches, best, 0);
    Rng rng(1);
    // So many that one without an outlier is among them, all but surely; the more inliers, the fewer.
    std::uint32_t needed = params_.trials;
    for (std::uint32_t trial = 0; trial < needed; ++trial) {
        const std::array<std::uint32_t, 3> pick{rng.next() % size, rng.next() % size, rng.next() % size};
        RigidMotion hypothesis = best;
        if (pick[0] == pick[1] || pick[1] == pick[2] || pick[0] == pick[2] || !fit(matches, pick, hypothesis)) {
            continue;
        }
        const std::uint32_t count = count_inliers(matches, hypothesis, most);
        if (count > most) {
            most = count;
            best = hypothesis;
            const double share = static_cast<double>(count) / static_cast<double>(size);
            needed = trials_for(share * share * share, params_.trials);
        }
    }
    return best;
}

bool EgomotionSolver::descend(std::span<const StereoMatch> matches, RigidMotion P_after_before, Egomotion& out) {
    mark_inliers(matches, P_after_before);
    for (int round = 0; round < kRounds; ++round) {
        const Normal n = normal_equations(matches, P_after_before);
        const Eigen::LDLT<Matrix6> ldlt(n.H);
        if (n.count < params_.inliers_min || !is_solvable(ldlt)) {
            return false;
        }
        const Vector6 step = ldlt.solve(n.b);
        P_after_before = motion_of(step) * P_after_before;
        constexpr int kChooseAgain = 3;
        if (round < kChooseAgain) {
            mark_inliers(matches, P_after_before);
        }
        if (step.squaredNorm() < square(kSettled)) {
            break;
        }
    }
    const Normal n = normal_equations(matches, P_after_before);
    if (n.count < params_.inliers_min) {
        return false;
    }
    const double freedom = 3.0 * static_cast<double>(n.count) - 6.0;
    out.P_before_after = P_after_before.inverse();
    out.covariance = n.H.inverse() * std::max(1.0, n.chi2 / freedom);
    out.inliers = n.count;
    out.rms_px = square_root(n.squares_px2 / (3.0 * static_cast<double>(n.count)));
    return is_finite(out.covariance.sum());
}

}  // namespace crspf
