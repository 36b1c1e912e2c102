#include "tools/calibrate/estimate.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <iterator>

#include "core/base/trig.hpp"

namespace crspf::calibrate {
namespace {

constexpr std::size_t kPiecesMin = 20;
constexpr int kTurnsMax = 50;
constexpr double kHuber = 2.0;        // standard deviations
constexpr Eigen::Index kOfPiece = 3;  // residuals: x, y, heading

double median_of_absolutes(std::vector<double> values) {
    const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
    std::transform(values.begin(), values.end(), values.begin(), [](double v) { return std::abs(v); });
    std::nth_element(values.begin(), middle, values.end());
    return *middle;
}

class Problem {
 public:
    Problem(const Drive& drive, Odometer odometer, std::span<const double> start)
        : drive_(&drive),
          odometer_(odometer),
          unknowns_(unknowns_of(odometer)),
          start_(start.begin(), start.end()),
          pieces_(drive.pieces) {
        // Those whose ends lie within the odometer's time wherever the stamp offset ends up.
        const double belief_s = unknowns_.back().belief;
        const Duration margin = Duration::from_seconds(belief_s);
        const std::vector<Moment> way = way_of(drive, odometer, start);
        std::erase_if(pieces_, [&](const Piece& piece) {
            return way.empty() || !(way.front().stamp < piece.from - margin) || !(piece.to + margin < way.back().stamp);
        });
    }

    [[nodiscard]] std::optional<Calibration> solve() {
        if (pieces_.size() < kPiecesMin) {
            return std::nullopt;
        }
        const auto n = static_cast<Eigen::Index>(unknowns_.size());
        Eigen::VectorXd x = Eigen::Map<const Eigen::VectorXd>(start_.data(), n);
        Eigen::MatrixXd information;
        for (int turn = 0; turn < kTurnsMax; ++turn) {
            const Eigen::VectorXd rest = rest_of(x);
            rescale(rest);
            const Eigen::VectorXd weight = weights_of(rest);
            const Eigen::MatrixXd slope = slope_at(x);
            information = slope.transpose() * weight.asDiagonal() * slope;
            Eigen::VectorXd pull = -slope.transpose() * weight.asDiagonal() * rest;
            for (Eigen::Index i = 0; i < n; ++i) {
                const double belief = unknowns_[static_cast<std::size_t>(i)].belief;
                information(i, i) += 1.0 / (belief * belief);
                pull(i) += (start_[static_cast<std::size_t>(i)] - x(i)) / (belief * belief);
            }
            const Eigen::VectorXd step = information.ldlt().solve(pull);
            x += step;
            const double left = step.transpose() * information * step;  // in squared standard deviations
            if (left < 1e-6) {
                break;
            }
        }
        const Eigen::MatrixXd covariance = information.ldlt().solve(Eigen::MatrixXd::Identity(n, n));
        Calibration found{.estimates = {}, .pieces = pieces_.size(), .rest_m = scale_m_, .rest_rad = scale_rad_};
        for (Eigen::Index i = 0; i < n; ++i) {
            found.estimates.push_back({.value = x(i), .stddev = std::sqrt(covariance(i, i))});
        }
        return found;
    }

 private:
    /// In metres and radians: three of each piece.
    [[nodiscard]] Eigen::VectorXd rest_of(const Eigen::VectorXd& x) const {
        const std::span values(x.data(), static_cast<std::size_t>(x.size()));
        const std::vector<Moment> way = way_of(*drive_, odometer_, values);
        const std::span lidar = values.last(4);
        const Pose2 P_base_lidar{.x_m = lidar[0], .y_m = lidar[1], .theta_rad = lidar[2]};
        const Duration later = Duration::from_seconds(lidar[3] - start_.back());
        Eigen::VectorXd rest(kOfPiece * static_cast<Eigen::Index>(pieces_.size()));
        Eigen::Index at = 0;
        for (const Piece& piece : pieces_) {
            const std::optional<Pose2> from = place_at(way, piece.from + later);
            const std::optional<Pose2> to = place_at(way, piece.to + later);
            Pose2 off;
            if (from && to) {
                const Pose2 told = inverse(*from * P_base_lidar) * (*to * P_base_lidar);
                off = inverse(piece.P_from_to) * told;
            }
            rest.segment(at, kOfPiece) << off.x_m, off.y_m, wrap_angle(off.theta_rad);
            at += kOfPiece;
        }
        return rest;
    }

    [[nodiscard]] Eigen::MatrixXd slope_at(const Eigen::VectorXd& x) const {
        Eigen::MatrixXd slope(kOfPiece * static_cast<Eigen::Index>(pieces_.size()), x.size());
        for (Eigen::Index i = 0; i < x.size(); ++i) {
            const double step = 1e-3 * unknowns_[static_cast<std::size_t>(i)].belief;
            Eigen::VectorXd more = x;
            Eigen::VectorXd less = x;
            more(i) += step;
            less(i) -= step;
            slope.col(i) = (rest_of(more) - rest_of(less)) / (2.0 * step);
        }
        return slope;
    }

    /// What the scans and the odometer leave over tells how far either is to be believed.
    void rescale(const Eigen::VectorXd& rest) {
        constexpr double kToStddev = 1.4826;  // of the median of absolutes, where errors are normal
        std::vector<double> position_m;
        std::vector<double> heading_rad;
        for (Eigen::Index i = 0; i < rest.size(); i += kOfPiece) {
            position_m.insert(position_m.end(), {rest(i), rest(i + 1)});
            heading_rad.push_back(rest(i + 2));
        }
        scale_m_ = std::max(kToStddev * median_of_absolutes(std::move(position_m)), 1e-5);
        scale_rad_ = std::max(kToStddev * median_of_absolutes(std::move(heading_rad)), 1e-5);
    }

    /// Huber's: a piece that fits badly, for a slip or a wrong match, pulls no harder than one at kHuber.
    [[nodiscard]] Eigen::VectorXd weights_of(const Eigen::VectorXd& rest) const {
        Eigen::VectorXd weights(rest.size());
        for (Eigen::Index i = 0; i < rest.size(); ++i) {
            const double scale = i % kOfPiece == 2 ? scale_rad_ : scale_m_;
            const double off = std::abs(rest(i)) / scale;
            weights(i) = (off > kHuber ? kHuber / off : 1.0) / (scale * scale);
        }
        return weights;
    }

    const Drive* drive_;
    Odometer odometer_;
    std::span<const Unknown> unknowns_;
    std::vector<double> start_;
    std::vector<Piece> pieces_;
    double scale_m_ = 0.0;
    double scale_rad_ = 0.0;
};

}  // namespace

std::optional<Calibration> estimate(const Drive& drive, Odometer odometer, std::span<const double> start) {
    return Problem(drive, odometer, start).solve();
}

}  // namespace crspf::calibrate
