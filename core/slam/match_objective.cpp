#include "core/slam/match_objective.hpp"

#include <algorithm>

#include "core/base/real.hpp"

namespace crspf {
MatchObjective::MatchObjective(const SlamParams& params, Kernel kernel)
    : pull_weight_(params.particle_filter.pull_weight),
      pull_saturation_(params.particle_filter.pull_saturation),
      critical_weight_(params.critical_rays.weight),
      cells_per_metre_(1.0 / params.map.resolution_m),
      sum_(field_sum_kernel(kernel)) {}

void MatchObjective::load(const ScanPoints& points, const std::array<bool, capacity::kBeams>& critical) {
    const auto scale = static_cast<float>(cells_per_metre_);
    constexpr auto kReach = static_cast<float>(MatchField::kReach);
    std::uint32_t used = 0;
    float farthest = 0.0F;
    double squares = 0.0;
    const auto take = [&](bool kind) {
        const std::uint32_t begin = used;
        for (std::uint32_t i = 0; i < points.count; ++i) {
            const float x = points.x_m[i] * scale;
            const float y = points.y_m[i] * scale;
            const float squared = x * x + y * y;
            if (critical[i] == kind && squared < kReach * kReach) {
                farthest = std::max(farthest, squared);
                squares += static_cast<double>(squared);
                x_[used] = x;
                y_[used] = y;
                ++used;
            }
        }
        return FieldPoints{.x = x_.data() + begin, .y = y_.data() + begin, .count = used - begin};
    };
    critical_ = take(true);
    ordinary_ = take(false);
    // P~ is in the tile right above the window's middle; two cells for the interpolation's neighbours and rounding.
    constexpr std::int32_t kTilesToEdge = FieldView::kTiles / 2 - 1;
    constexpr double kNearestEdge = kTilesToEdge * TileGeometry::kSide - 2;
    reach_m_ = (kNearestEdge - square_root(static_cast<double>(farthest))) / cells_per_metre_;
    rms_range_m_ = used > 0 ? square_root(squares / static_cast<double>(used)) / cells_per_metre_ : 0.0;
    weight_sum_ = critical_weight_ * static_cast<double>(critical_.count) + static_cast<double>(ordinary_.count);
}

bool MatchObjective::aim(const MatchField& field, const Pose2& P_map_observed, const MotionPrior& prior) {
    observed_ = P_map_observed;
    prior_ = prior;
    translation_precision_ = 1.0 / square(prior.translation_stddev_m);
    const double x = P_map_observed.x_m * cells_per_metre_;
    const double y = P_map_observed.y_m * cells_per_metre_;
    constexpr double kExtent = TileGeometry::kHalf;
    if (!(absolute(x) < kExtent && absolute(y) < kExtent)) {
        return false;
    }
    return field.view_around({.x = floor_to_cell(x), .y = floor_to_cell(y)}, view_);
}

double MatchObjective::match(const Pose2& P_map_base) const {
    const FieldPose pose = view_.place(P_map_base, cells_per_metre_);
    const double sum = critical_weight_ * static_cast<double>(sum_(view_, critical_, pose)) +
                       static_cast<double>(sum_(view_, ordinary_, pose));
    return sum / (kFieldScale * weight_sum_);
}

double MatchObjective::match_seen(const Pose2& P_map_base) const {
    const FieldPose pose = view_.place(P_map_base, cells_per_metre_);
    double sum = 0.0;
    double seen = 0.0;
    for (std::uint32_t i = 0; i < rays(); ++i) {
        const float x = (pose.cos * x_[i] - pose.sin * y_[i]) + pose.x;
        const float y = (pose.sin * x_[i] + pose.cos * y_[i]) + pose.y;
        const FieldValue raw = view_.raw(static_cast<std::int32_t>(x), static_cast<std::int32_t>(y));
        if ((raw & kSeen) != 0) {
            sum += weight(i) * static_cast<double>(raw & kSumMask);
            seen += weight(i);
        }
    }
    constexpr double kLeastSeen = 0.2;
    return seen > kLeastSeen * weight_sum_ ? sum / (kFieldScale * seen) : -1.0;
}

double MatchObjective::pull(const Pose2& P_map_base) const {
    const double squared =
        translation_precision_ * (square(P_map_base.x_m - observed_.x_m) + square(P_map_base.y_m - observed_.y_m));
    return pull_weight_ * squared / (1.0 + squared / pull_saturation_);
}

double MatchObjective::pull_curvature(const Pose2& P_map_base) const {
    const double squared =
        translation_precision_ * (square(P_map_base.x_m - observed_.x_m) + square(P_map_base.y_m - observed_.y_m));
    return pull_weight_ * translation_precision_ / square(1.0 + squared / pull_saturation_);
}

MatchObjective::Linearized MatchObjective::linearize(const Pose2& P_map_base) const {
    const SinCos r = sin_cos(P_map_base.theta_rad);
    // A cell's value stands for its centre: half a cell back, and the whole part names the lower left of four centres.
    const double at_x = P_map_base.x_m * cells_per_metre_ - static_cast<double>(view_.corner.x) - 0.5;
    const double at_y = P_map_base.y_m * cells_per_metre_ - static_cast<double>(view_.corner.y) - 0.5;
    Linearized sum;
    Covariance3& h = sum.information;
    for (std::uint32_t i = 0; i < rays(); ++i) {
        const auto px = static_cast<double>(x_[i]);
        const auto py = static_cast<double>(y_[i]);
        const double rx = r.cos * px - r.sin * py;
        const double ry = r.sin * px + r.cos * py;
        const double x = rx + at_x;
        const double y = ry + at_y;
        const auto ix = static_cast<std::int32_t>(x);
        const auto iy = static_cast<std::int32_t>(y);
        const double u = x - static_cast<double>(ix);
        const double v = y - static_cast<double>(iy);
        const FieldView::Square around = view_.square(ix, iy);
        const auto lower_left = static_cast<double>(around[0]);
        const auto lower_right = static_cast<double>(around[1]);
        const auto upper_left = static_cast<double>(around[2]);
        const auto upper_right = static_cast<double>(around[3]);
        const double lower = lower_left + u * (lower_right - lower_left);
        const double upper = upper_left + u * (upper_right - upper_left);
        constexpr double kUnit = 1.0 / kFieldMax;
        const double f = kUnit * (lower + v * (upper - lower));
        const double fx = kUnit * ((lower_right - lower_left) * (1.0 - v) + (upper_right - upper_left) * v);
        const double fy = kUnit * (upper - lower);
        const double ft = fy * rx - fx * ry;
        const double a = weight(i);
        sum.match += a * f;
        sum.gradient[0] += a * (1.0 - f) * fx;
        sum.gradient[1] += a * (1.0 - f) * fy;
        sum.gradient[2] += a * (1.0 - f) * ft;
        h.xx += a * fx * fx;
        h.xy += a * fx * fy;
        h.yy += a * fy * fy;
        h.xt += a * fx * ft;
        h.yt += a * fy * ft;
        h.tt += a * ft * ft;
    }
    const double mean = 1.0 / weight_sum_;
    const double mean_per_m = mean * cells_per_metre_;
    const double mean_per_m2 = mean_per_m * cells_per_metre_;
    sum.match *= mean;
    sum.gradient[0] *= mean_per_m;
    sum.gradient[1] *= mean_per_m;
    sum.gradient[2] *= mean;
    h.xx *= mean_per_m2;
    h.xy *= mean_per_m2;
    h.yy *= mean_per_m2;
    h.xt *= mean_per_m;
    h.yt *= mean_per_m;
    h.tt *= mean;
    return sum;
}

}  // namespace crspf
