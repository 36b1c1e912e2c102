#include "tools/eval/scan_alignment.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

#include "tools/eval/wall_field.hpp"

namespace crspf::eval {
namespace {

using Eigen::Vector2d;
using Points = std::vector<Vector2d>;

constexpr std::size_t kFewestPoints = 30;  // of a scan, thinned out
constexpr std::size_t kPlaces = 6;         // of the search that are followed up
constexpr double kOnWall_m = 0.1;

Vector2d rotate(const SinCos& turn, const Vector2d& p) {
    return {turn.cos * p.x() - turn.sin * p.y(), turn.sin * p.x() + turn.cos * p.y()};
}

/// Hits near the lidar lie dense and would outweigh the others.
Points thin_out(const ScanHits& scan) {
    constexpr double kSpacing_m = 0.05;
    Points kept;
    for (const Eigen::Vector2f& hit : scan.points) {
        const Vector2d p = hit.cast<double>();
        if ((p - scan.lidar).norm() < kFarthestHit_m && (kept.empty() || (p - kept.back()).norm() >= kSpacing_m)) {
            kept.push_back(p);
        }
    }
    return kept;
}

/// The correlative search: the score of each place of a lattice, in steps of whole cells.
class Search {
 public:
    Search(const WallField& field, const Points& points, const Pose2& guess, const ScanWindow& window)
        : guess_(guess),
          shifts_(static_cast<int>(std::ceil(window.half_width_m / kStep_m))),
          turns_(static_cast<int>(std::ceil(window.half_turn_rad / kStep_rad))) {
        const std::size_t stride = points.size() / kSample + 1;
        scores_.reserve(static_cast<std::size_t>(2 * turns_ + 1) * static_cast<std::size_t>(2 * shifts_ + 1) *
                        static_cast<std::size_t>(2 * shifts_ + 1));
        const int border = shifts_ * kStep_cells;
        std::vector<std::ptrdiff_t> places;
        for (int turn = -turns_; turn <= turns_; ++turn) {
            places.clear();
            const SinCos heading = sin_cos(guess.theta_rad + turn * kStep_rad);
            for (std::size_t i = 0; i < points.size(); i += stride) {
                const std::ptrdiff_t at =
                    field.place(rotate(heading, points[i]) + Vector2d(guess.x_m, guess.y_m), border);
                if (at >= 0) {  // else no step of the window brings it near a wall
                    places.push_back(at);
                }
            }
            for (int dy = -shifts_; dy <= shifts_; ++dy) {
                for (int dx = -shifts_; dx <= shifts_; ++dx) {
                    const std::uint8_t* const nearness =
                        field.nearness().data() + static_cast<std::ptrdiff_t>(kStep_cells) *
                                                      (static_cast<std::ptrdiff_t>(dy) * field.width() + dx);
                    std::int32_t score = 0;
                    for (const std::ptrdiff_t at : places) {
                        score += nearness[at];
                    }
                    scores_.push_back(score);
                }
            }
        }
    }

    /// How far beyond the hits the field must reach. [m]
    static double margin_m(const ScanWindow& window) {
        return 2.0 * (window.half_width_m + kStep_m) + WallField::kReach_m;
    }

    /// The best places, each outside the neighbourhood of the better ones.
    std::vector<Pose2> best_places() {
        std::vector<Pose2> best;
        const int side = 2 * shifts_ + 1;
        while (best.size() < kPlaces) {
            const auto top = std::max_element(scores_.begin(), scores_.end());
            if (*top <= 0) {
                break;
            }
            const auto at = static_cast<int>(top - scores_.begin());
            const int dx = at % side - shifts_;
            const int dy = at / side % side - shifts_;
            const int turn = at / (side * side) - turns_;
            best.push_back({.x_m = guess_.x_m + dx * kStep_m,
                            .y_m = guess_.y_m + dy * kStep_m,
                            .theta_rad = wrap_angle(guess_.theta_rad + turn * kStep_rad)});
            clear_about(dx, dy, turn);
        }
        return best;
    }

 private:
    static constexpr int kStep_cells = 3;
    static constexpr double kStep_m = kStep_cells * WallField::kCell_m;
    static constexpr double kStep_rad = radians(2.0);
    static constexpr std::size_t kSample = 90;

    void clear_about(int x, int y, int turn) {
        constexpr int kShifts = 2;
        constexpr int kTurns = 3;
        const std::ptrdiff_t side = 2 * shifts_ + 1;
        for (int t = std::max(turn - kTurns, -turns_); t <= std::min(turn + kTurns, turns_); ++t) {
            for (int dy = std::max(y - kShifts, -shifts_); dy <= std::min(y + kShifts, shifts_); ++dy) {
                for (int dx = std::max(x - kShifts, -shifts_); dx <= std::min(x + kShifts, shifts_); ++dx) {
                    const std::ptrdiff_t at = ((t + turns_) * side + dy + shifts_) * side + dx + shifts_;
                    scores_[static_cast<std::size_t>(at)] = 0;
                }
            }
        }
    }

    Pose2 guess_;
    int shifts_;
    int turns_;
    std::vector<std::int32_t> scores_;
};

/// The normal equations of the point-to-line distances within `gate_m`, turned about the scan's base_link.
struct Equations {
    Eigen::Matrix3d hessian = Eigen::Matrix3d::Zero();
    Eigen::Vector3d gradient = Eigen::Vector3d::Zero();
    double weight = 0.0;
};

Equations equations_at(const Pose2& pose, const Points& points, const WallField& field, double gate_m) {
    constexpr double kHuber_m = 0.03;  // twice the noise of a lidar
    Equations e;
    const SinCos turn = sin_cos(pose.theta_rad);
    for (const Vector2d& point : points) {
        const Vector2d arm = rotate(turn, point);
        const Vector2d p = arm + Vector2d(pose.x_m, pose.y_m);
        const WallField::Wall* const wall = field.wall_near(p);
        if (wall == nullptr || (p - wall->point).norm() > gate_m) {
            continue;
        }
        const double distance_m = wall->normal.dot(p - wall->point);
        const Eigen::Vector3d row(wall->normal.x(), wall->normal.y(),
                                  wall->normal.y() * arm.x() - wall->normal.x() * arm.y());
        const double weight = std::min(1.0, kHuber_m / std::max(std::abs(distance_m), 1e-9));
        e.hessian += weight * row * row.transpose();
        e.gradient += weight * distance_m * row;
        e.weight += weight;
    }
    return e;
}

/// Point-to-line ICP with a narrowing gate.
Pose2 refine(Pose2 pose, const Points& points, const WallField& field) {
    constexpr std::array<double, 3> kGates_m = {0.3, 0.2, kOnWall_m};
    constexpr int kIterations = 10;
    constexpr double kLongestStep = 0.2;  // [m] and [rad]
    constexpr double kConverged = 1e-5;
    for (const double gate_m : kGates_m) {
        for (int i = 0; i < kIterations; ++i) {
            Equations e = equations_at(pose, points, field, gate_m);
            // Keeps the direction that a bare corridor leaves open where it is.
            e.hessian.diagonal() += Eigen::Vector3d::Constant(1e-3 * (e.weight + 1.0));
            Eigen::Vector3d step = e.hessian.ldlt().solve(e.gradient);
            const double length = step.lpNorm<Eigen::Infinity>();
            if (length > kLongestStep) {
                step *= kLongestStep / length;
            }
            pose = {.x_m = pose.x_m - step.x(),
                    .y_m = pose.y_m - step.y(),
                    .theta_rad = wrap_angle(pose.theta_rad - step.z())};
            if (length < kConverged) {
                break;
            }
        }
    }
    return pose;
}

/// What one scan's hits say of the other's field.
struct Votes {
    double on_wall = 0.0;
    double against = 0.0;  ///< where the other scan looked through

    Votes& operator+=(const Votes& other) {
        on_wall += other.on_wall;
        against += other.against;
        return *this;
    }
    [[nodiscard]] double score() const { return on_wall - against; }
};

Votes votes_at(const Pose2& pose, const Points& points, const WallField& field) {
    Votes votes;
    const SinCos turn = sin_cos(pose.theta_rad);
    for (const Vector2d& point : points) {
        const Vector2d p = rotate(turn, point) + Vector2d(pose.x_m, pose.y_m);
        const WallField::Wall* const wall = field.wall_near(p);
        const double distance_m = wall == nullptr ? WallField::kReach_m : (p - wall->point).norm();
        if (distance_m <= kOnWall_m) {
            votes.on_wall += 1.0;
        } else if (distance_m > 2.0 * kOnWall_m && field.looked_through(p)) {
            votes.against += 1.0;
        }
    }
    return votes;
}

/// The least part of the walls' weight that holds the scan in any direction, whatever it does about its heading.
double least_observed(const Equations& e) {
    if (!(e.weight > 0.0) || !(e.hessian(2, 2) > 0.0)) {
        return 0.0;
    }
    const Eigen::Matrix2d shift = e.hessian.topLeftCorner<2, 2>() - e.hessian.topRightCorner<2, 1>() *
                                                                        e.hessian.bottomLeftCorner<1, 2>() /
                                                                        e.hessian(2, 2);
    return std::max(0.0, Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d>(shift).eigenvalues().x()) / e.weight;
}

bool same_place(const Pose2& a, const Pose2& b) {
    constexpr double kNear_m = 0.1;
    constexpr double kNear_rad = radians(3.0);
    return std::hypot(a.x_m - b.x_m, a.y_m - b.y_m) < kNear_m &&
           std::abs(wrap_angle(a.theta_rad - b.theta_rad)) < kNear_rad;
}

}  // namespace

ScanAlignment align_scans(const ScanHits& reference, const ScanHits& scan, const Pose2& P_reference_scan_guess,
                          const ScanWindow& window) {
    const Points points = thin_out(scan);
    const Points reference_points = thin_out(reference);
    ScanAlignment result;
    if (points.size() < kFewestPoints || reference_points.size() < kFewestPoints) {
        return result;
    }
    const WallField field(reference, Search::margin_m(window));
    const WallField scan_field(scan, WallField::kReach_m);

    struct Place {
        Pose2 pose;
        Votes votes;
    };
    std::vector<Place> places;
    for (const Pose2& start : Search(field, points, P_reference_scan_guess, window).best_places()) {
        const Pose2 pose = refine(start, points, field);
        Votes votes = votes_at(pose, points, field);
        votes += votes_at(inverse(pose), reference_points, scan_field);
        places.push_back({.pose = pose, .votes = votes});
    }
    result.verdict = AlignmentVerdict::kNoFit;
    if (places.empty()) {
        return result;
    }
    const Place best = *std::max_element(
        places.begin(), places.end(), [](const Place& a, const Place& b) { return a.votes.score() < b.votes.score(); });
    result.P_reference_scan = best.pose;
    const double judged = best.votes.on_wall + best.votes.against;
    result.inlier_share = judged > 0.0 ? best.votes.on_wall / judged : 0.0;
    constexpr double kInliers = 0.8;
    constexpr double kShared = 0.4;
    const auto all = static_cast<double>(points.size() + reference_points.size());
    if (result.inlier_share < kInliers || best.votes.on_wall < kShared * all) {
        return result;
    }
    result.observed_share = least_observed(equations_at(best.pose, points, field, kOnWall_m));
    constexpr double kObserved = 0.05;
    if (result.observed_share < kObserved) {
        result.verdict = AlignmentVerdict::kDegenerate;
        return result;
    }
    for (const Place& place : places) {
        if (!same_place(place.pose, best.pose)) {
            result.runner_up_share = std::max(result.runner_up_share, place.votes.score() / best.votes.score());
        }
    }
    constexpr double kRunnerUp = 0.8;
    if (result.runner_up_share > kRunnerUp) {
        result.verdict = AlignmentVerdict::kAmbiguous;
        return result;
    }
    const Pose2& guess = P_reference_scan_guess;
    const bool inside = std::abs(best.pose.x_m - guess.x_m) < window.half_width_m &&
                        std::abs(best.pose.y_m - guess.y_m) < window.half_width_m &&
                        std::abs(wrap_angle(best.pose.theta_rad - guess.theta_rad)) < window.half_turn_rad;
    result.verdict = inside ? AlignmentVerdict::kGood : AlignmentVerdict::kAtWindowEdge;
    return result;
}

}  // namespace crspf::eval
