#include "tools/eval/map_error.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <stdexcept>
#include <vector>

#include "platform/files/input_error.hpp"
#include "tools/eval/nearest_point.hpp"

namespace crspf::eval {
namespace {

using Eigen::Vector2d;
using Points = std::vector<Vector2d>;

constexpr double kMostCells = 64e6;      // of a distance field or a resampled map: 256 MB
constexpr double kMostCandidates = 2e6;  // of the exhaustive search: half a minute at worst

/// A pose with its sine and cosine at hand.
struct Transform {
    explicit Transform(const Pose2& pose) : shift(pose.x_m, pose.y_m), turn(sin_cos(pose.theta_rad)) {}
    [[nodiscard]] Vector2d rotate(const Vector2d& p) const {
        return {turn.cos * p.x() - turn.sin * p.y(), turn.sin * p.x() + turn.cos * p.y()};
    }
    [[nodiscard]] Vector2d operator*(const Vector2d& p) const { return rotate(p) + shift; }

    Vector2d shift;
    SinCos turn;
};

/// Centres of the occupied cells of `map` resampled to `cell_m`, in the frame of its lower-left corner.
Points occupied_centres(const GridMap& map, double cell_m) {
    const double ratio = map.resolution_m / cell_m;
    // A sliver that rounding leaves over is not a column or row of its own.
    const double columns = std::max(1.0, std::ceil(map.width * ratio - 1e-6));
    const double rows = std::max(1.0, std::ceil(map.height * ratio - 1e-6));
    if (!(columns * rows <= kMostCells)) {
        throw InputError("the built map has too many cells at the resolution of the truth; check both resolutions");
    }
    GridMap resampled;
    resampled.width = static_cast<int>(columns);
    resampled.height = static_cast<int>(rows);
    resampled.cells.assign(static_cast<std::size_t>(columns * rows), GridCell::kFree);
    const auto cell_at = [&resampled](int column, int row) -> GridCell& {
        const int c = std::min(column, resampled.width - 1);
        const int r = std::min(row, resampled.height - 1);
        return resampled.cells[static_cast<std::size_t>(r) * static_cast<std::size_t>(resampled.width) +
                               static_cast<std::size_t>(c)];
    };
    // Fine to coarse: whichever cell holds an occupied centre. No thin wall gets lost.
    for (int row = 0; row < map.height; ++row) {
        for (int column = 0; column < map.width; ++column) {
            if (map.at(column, row) == GridCell::kOccupied) {
                cell_at(static_cast<int>((column + 0.5) * ratio), static_cast<int>((row + 0.5) * ratio)) =
                    GridCell::kOccupied;
            }
        }
    }
    Points centres;
    for (int row = 0; row < resampled.height; ++row) {
        for (int column = 0; column < resampled.width; ++column) {
            // Coarse to fine: every cell whose centre lies in an occupied one.
            const int source_column = std::min(static_cast<int>((column + 0.5) / ratio), map.width - 1);
            const int source_row = std::min(static_cast<int>((row + 0.5) / ratio), map.height - 1);
            if (cell_at(column, row) == GridCell::kOccupied ||
                map.at(source_column, source_row) == GridCell::kOccupied) {
                centres.emplace_back((column + 0.5) * cell_m, (row + 0.5) * cell_m);
            }
        }
    }
    return centres;
}

/// Distance to the truth's nearest occupied centre, cut off, sampled at the centres of its cells and of a margin.
class DistanceField {
 public:
    struct Sample {
        double value_m;
        Vector2d gradient;
    };

    DistanceField(const GridMap& truth, const NearestPoint& nearest, double cut_off_m)
        : cell_m_(truth.resolution_m), cut_off_m_(cut_off_m) {
        const double margin = std::ceil(cut_off_m / cell_m_) + 1.0;
        if (!((truth.width + 2.0 * margin) * (truth.height + 2.0 * margin) <= kMostCells)) {
            throw InputError("the true map has more than 64 million cells; use a coarser one");
        }
        margin_ = static_cast<int>(margin);
        width_ = truth.width + 2 * margin_;
        height_ = truth.height + 2 * margin_;
        distance_m_.reserve(static_cast<std::size_t>(width_) * static_cast<std::size_t>(height_));
        for (int row = 0; row < height_; ++row) {
            for (int column = 0; column < width_; ++column) {
                const Vector2d centre((column - margin_ + 0.5) * cell_m_, (row - margin_ + 0.5) * cell_m_);
                distance_m_.push_back(static_cast<float>(nearest.distance(centre, cut_off_m)));
            }
        }
    }

    [[nodiscard]] double cell_m() const { return cell_m_; }

    /// Of the cell that holds `p`. [m]
    [[nodiscard]] double at(const Vector2d& p) const {
        const double column = p.x() / cell_m_ + margin_;
        const double row = p.y() / cell_m_ + margin_;
        if (!(column >= 0.0 && row >= 0.0 && column < width_ && row < height_)) {
            return cut_off_m_;
        }
        return cell(static_cast<int>(column), static_cast<int>(row));
    }

    /// Interpolated between four centres.
    [[nodiscard]] Sample interpolate(const Vector2d& p) const {
        const double x = p.x() / cell_m_ + margin_ - 0.5;
        const double y = p.y() / cell_m_ + margin_ - 0.5;
        if (!(x >= 0.0 && y >= 0.0 && x < width_ - 1 && y < height_ - 1)) {
            return {.value_m = cut_off_m_, .gradient = Vector2d::Zero()};
        }
        const int column = static_cast<int>(x);
        const int row = static_cast<int>(y);
        const double u = x - column;
        const double v = y - row;
        const double d00 = cell(column, row);
        const double d10 = cell(column + 1, row);
        const double d01 = cell(column, row + 1);
        const double d11 = cell(column + 1, row + 1);
        const double low = d00 + u * (d10 - d00);
        const double high = d01 + u * (d11 - d01);
        return {.value_m = low + v * (high - low),
                .gradient = Vector2d((1.0 - v) * (d10 - d00) + v * (d11 - d01), high - low) / cell_m_};
    }

 private:
    [[nodiscard]] double cell(int column, int row) const {
        return static_cast<double>(distance_m_[static_cast<std::size_t>(row) * static_cast<std::size_t>(width_) +
                                               static_cast<std::size_t>(column)]);
    }

    double cell_m_;
    double cut_off_m_;
    int margin_ = 0;
    int width_ = 0;
    int height_ = 0;
    std::vector<float> distance_m_;
};

/// The poses that the alignment may take: those of the built map's pivot in the truth's grid.
class Bounds {
 public:
    Bounds(const Pose2& middle, const AlignmentWindow& window) : middle_(middle), window_(window) {}

    [[nodiscard]] Pose2 clamp(const Pose2& pose) const {
        const double width = window_.half_width_m;
        const double turn = wrap_angle(pose.theta_rad - middle_.theta_rad);
        return {.x_m = std::clamp(pose.x_m, middle_.x_m - width, middle_.x_m + width),
                .y_m = std::clamp(pose.y_m, middle_.y_m - width, middle_.y_m + width),
                .theta_rad =
                    wrap_angle(middle_.theta_rad + std::clamp(turn, -window_.half_turn_rad, window_.half_turn_rad))};
    }

    [[nodiscard]] bool at_edge(const Pose2& pose) const {
        constexpr double kTouch = 1e-9;
        const auto touches = [](double offset, double half) { return half > 0.0 && std::abs(offset) > half - kTouch; };
        return touches(pose.x_m - middle_.x_m, window_.half_width_m) ||
               touches(pose.y_m - middle_.y_m, window_.half_width_m) ||
               (window_.half_turn_rad < kPi - kTouch &&
                touches(wrap_angle(pose.theta_rad - middle_.theta_rad), window_.half_turn_rad));
    }

    /// All poses of a grid with at most these steps, the middle and the edges among them.
    [[nodiscard]] std::vector<Pose2> grid(double step_m, double step_rad) const {
        const double shifts = std::ceil(window_.half_width_m / step_m);
        const double turns = std::ceil(window_.half_turn_rad / step_rad);
        const double total = (2.0 * shifts + 1.0) * (2.0 * shifts + 1.0) * (2.0 * turns + 1.0);
        if (!(total <= kMostCandidates)) {
            throw InputError("the search window is too large; narrow it about a better initial alignment");
        }
        const auto offsets = [](double half, double steps) {
            const int n = static_cast<int>(steps);
            std::vector<double> result;
            for (int i = -n; i <= n; ++i) {
                result.push_back(n > 0 ? half * i / n : 0.0);
            }
            return result;
        };
        const std::vector<double> shifts_m = offsets(window_.half_width_m, shifts);
        std::vector<Pose2> poses;
        poses.reserve(static_cast<std::size_t>(total));
        for (const double turn_rad : offsets(window_.half_turn_rad, turns)) {
            for (const double dy_m : shifts_m) {
                for (const double dx_m : shifts_m) {
                    poses.push_back({.x_m = middle_.x_m + dx_m,
                                     .y_m = middle_.y_m + dy_m,
                                     .theta_rad = wrap_angle(middle_.theta_rad + turn_rad)});
                }
            }
        }
        return poses;
    }

 private:
    Pose2 middle_;
    AlignmentWindow window_;
};

/// About `count` of the points. The golden ratio keeps the choice even without keeping step with rows of walls.
Points thin_out(const Points& points, std::size_t count) {
    if (points.size() <= count) {
        return points;
    }
    constexpr double kGolden = std::numbers::phi - 1.0;
    Points chosen;
    for (std::size_t i = 0; i < count; ++i) {
        const double place = std::fmod(static_cast<double>(i) * kGolden, 1.0) * static_cast<double>(points.size());
        chosen.push_back(points[static_cast<std::size_t>(place)]);
    }
    return chosen;
}

/// What a point at distance `d_m` of the truth costs: about its distance, so that a minority of misplaced walls does
/// not pull the others (as squares would), but smooth within half a cell, the rounding of a grid (pseudo-Huber).
struct Loss {
    double cell_m;

    [[nodiscard]] double cost(double d_m) const { return std::sqrt(d_m * d_m + scale() * scale()) - scale(); }
    /// cost' / d
    [[nodiscard]] double weight(double d_m) const { return 1.0 / std::sqrt(d_m * d_m + scale() * scale()); }
    [[nodiscard]] double scale() const { return 0.5 * cell_m; }
};

/// The cost of the points at a pose, and its reweighted normal equations.
struct Fit {
    Pose2 pose;
    double cost_m = 0.0;
    Eigen::Matrix3d hessian = Eigen::Matrix3d::Zero();
    Eigen::Vector3d gradient = Eigen::Vector3d::Zero();
};

Fit fit_at(const Pose2& pose, const Points& points, const DistanceField& field) {
    Fit fit{.pose = pose};
    const Transform transform(pose);
    const Loss loss{field.cell_m()};
    for (const Vector2d& p : points) {
        const Vector2d arm = transform.rotate(p);
        const auto [value_m, gradient] = field.interpolate(arm + transform.shift);
        const Eigen::Vector3d row(gradient.x(), gradient.y(), gradient.y() * arm.x() - gradient.x() * arm.y());
        const double weight = loss.weight(value_m);
        fit.cost_m += loss.cost(value_m);
        fit.hessian += weight * row * row.transpose();
        fit.gradient += weight * value_m * row;
    }
    return fit;
}

/// Gauss-Newton, damped (Levenberg-Marquardt), inside the bounds. Never worse than `start`.
Fit refine(const Pose2& start, const Points& points, const DistanceField& field, const Bounds& bounds) {
    constexpr int kIterations = 60;
    constexpr double kConverged = 1e-9;  // [m] and [rad]
    double damping = 1e-4;
    Fit best = fit_at(start, points, field);
    for (int i = 0; i < kIterations; ++i) {
        Eigen::Matrix3d damped = best.hessian;
        damped.diagonal() += damping * best.hessian.diagonal() + Eigen::Vector3d::Constant(1e-12);
        const Eigen::Vector3d step = damped.ldlt().solve(best.gradient);
        const Fit next = fit_at(bounds.clamp({.x_m = best.pose.x_m - step.x(),
                                              .y_m = best.pose.y_m - step.y(),
                                              .theta_rad = wrap_angle(best.pose.theta_rad - step.z())}),
                                points, field);
        if (next.cost_m < best.cost_m) {
            best = next;
            damping *= 0.2;
        } else {
            damping = std::max(damping, 1e-4) * 10.0;
        }
        if (step.lpNorm<Eigen::Infinity>() < kConverged) {
            break;
        }
    }
    return best;
}

/// `points` are relative to their mean.
Pose2 align(const Points& points, const DistanceField& field, const Bounds& bounds, double step_m) {
    constexpr std::size_t kSample = 500;
    constexpr std::size_t kStarts = 32;
    double squares_m2 = 0.0;
    for (const Vector2d& p : points) {
        squares_m2 += p.squaredNorm();
    }
    // A turn by one step moves the points as far as a shift by one step.
    const double radius_m = std::max(step_m, std::sqrt(squares_m2 / static_cast<double>(points.size())));
    const Points sample = thin_out(points, kSample);

    struct Candidate {
        double cost_m;
        Pose2 pose;
        bool operator<(const Candidate& other) const { return cost_m < other.cost_m; }
    };
    std::vector<Candidate> best_places;  // a heap, the worst in front
    for (const Pose2& pose : bounds.grid(step_m, step_m / radius_m)) {
        const bool full = best_places.size() == kStarts;
        const double cost_max_m = full ? best_places.front().cost_m : std::numeric_limits<double>::infinity();
        const Transform transform(pose);
        double cost_m = 0.0;
        for (auto p = sample.begin(); p != sample.end() && cost_m < cost_max_m; ++p) {
            cost_m += field.at(transform * *p);
        }
        if (cost_m >= cost_max_m) {
            continue;
        }
        if (full) {
            std::pop_heap(best_places.begin(), best_places.end());
            best_places.pop_back();
        }
        best_places.push_back({.cost_m = cost_m, .pose = pose});
        std::push_heap(best_places.begin(), best_places.end());
    }
    Fit best = refine(best_places.front().pose, sample, field, bounds);
    for (const Candidate& candidate : best_places) {
        const Fit fit = refine(candidate.pose, sample, field, bounds);
        if (fit.cost_m < best.cost_m) {
            best = fit;
        }
    }
    return refine(best.pose, points, field, bounds).pose;
}

std::vector<double> distances(const Points& from, const Transform& transform, const NearestPoint& to) {
    std::vector<double> all_m;
    all_m.reserve(from.size());
    for (const Vector2d& p : from) {
        all_m.push_back(to.distance(transform * p));
    }
    return all_m;
}

}  // namespace

MapError map_error(const GridMap& built, const GridMap& truth, const AlignmentWindow& window) {
    const double cell_m = truth.resolution_m;
    const Points true_points = occupied_centres(truth, cell_m);
    Points built_points = occupied_centres(built, cell_m);
    if (true_points.empty() || built_points.empty()) {
        throw std::invalid_argument("map_error: a map without occupied cells");
    }
    Vector2d pivot = Vector2d::Zero();
    for (const Vector2d& p : built_points) {
        pivot += p / static_cast<double>(built_points.size());
    }
    for (Vector2d& p : built_points) {
        p -= pivot;
    }
    const NearestPoint nearest_true(true_points);
    const double cut_off_m = std::max(0.5, 5.0 * cell_m);
    const DistanceField field(truth, nearest_true, cut_off_m);
    const Pose2 P_built_pivot = built.P_map_origin * Pose2{.x_m = pivot.x(), .y_m = pivot.y()};
    const Pose2 P_grid_truth = inverse(truth.P_map_origin);
    const Bounds bounds(P_grid_truth * window.P_truth_built * P_built_pivot, window);
    const Pose2 P_grid_pivot = align(built_points, field, bounds, std::max(0.2, 2.0 * cell_m));
    const NearestPoint nearest_built(built_points);
    const Summary built_to_truth_m = summarise(distances(built_points, Transform(P_grid_pivot), nearest_true));
    return {.P_truth_built = truth.P_map_origin * P_grid_pivot * inverse(P_built_pivot),
            .at_window_edge = bounds.at_edge(P_grid_pivot),
            .lies_elsewhere = built_to_truth_m.median > cut_off_m,
            .cell_m = cell_m,
            .built_to_truth_m = built_to_truth_m,
            .truth_to_built_m = summarise(distances(true_points, Transform(inverse(P_grid_pivot)), nearest_built))};
}

}  // namespace crspf::eval
