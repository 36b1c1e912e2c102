#include "core/slam/match_objective.hpp"

#include <algorithm>

#include "core/base/real.hpp"

namespace crspf {

MatchObjective::MatchObjective(const SlamParams& params, Kernel kernel)
    : pull_weight_(params.particle_filter.pull_weight),
      pull_saturation_(params.particle_filter.pull_saturation),
      critical_weight_(params.critical_rays.weight),
      cells_per_metre_(1.0 / params.map.resolution_m),
      sum_(field_sum_kernel(kernel)),
      slope_sum_(slope_sum_kernel(kernel)) {}

void MatchObjective::load(const ScanPoints& points, const std::array<bool, capacity::kBeams>& critical,
                          const SurfaceNormals& normals) {
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
                rays_.x[used] = x;
                rays_.y[used] = y;
                rays_.weight[used] = kind ? static_cast<float>(critical_weight_) : 1.0F;
                const float normal_x = kind ? 0.0F : normals.x(i);
                const float normal_y = kind ? 0.0F : normals.y(i);
                rays_.normal_x[used] = normal_x;
                rays_.normal_y[used] = normal_y;
                rays_.free[used] = normal_x == 0.0F && normal_y == 0.0F ? 1.0F : 0.0F;
                ++used;
            }
        }
        return FieldPoints{.x = rays_.x.data() + begin, .y = rays_.y.data() + begin, .count = used - begin};
    };
    critical_ = take(true);
    ordinary_ = take(false);
    rays_.count = used;
    for (std::uint32_t i = used; i % RayTable::kLanes != 0; ++i) {
        for (RayTable::PerRay* column :
             {&rays_.x, &rays_.y, &rays_.weight, &rays_.normal_x, &rays_.normal_y, &rays_.free}) {
            (*column)[i] = 0.0F;
        }
    }
    // P~ is in the tile right above the window's middle; two cells for the interpolation's neighbours and rounding.
    constexpr std::int32_t kTilesToEdge = FieldView::kTiles / 2 - 1;
    constexpr double kNearestEdge = kTilesToEdge * TileGeometry::kSide - 2;
    reach_m_ = (kNearestEdge - square_root(static_cast<double>(farthest))) / cells_per_metre_;
    rms_range_m_ = used > 0 ? square_root(squares / static_cast<double>(used)) / cells_per_metre_ : 0.0;
    weight_sum_ = critical_weight_ * static_cast<double>(critical_.count) + static_cast<double>(ordinary_.count);
}

bool MatchObjective::aim(const MatchField& field, const Pose2& P_map_observed, const MotionPrior& prior,
                         double heading_trust) {
    observed_ = P_map_observed;
    prior_ = prior;
    translation_precision_ = 1.0 / square(prior.translation_stddev_m);
    rotation_precision_ = heading_trust / square(prior.rotation_stddev_rad);
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
        const float x = (pose.cos * rays_.x[i] - pose.sin * rays_.y[i]) + pose.x;
        const float y = (pose.sin * rays_.x[i] + pose.cos * rays_.y[i]) + pose.y;
        const FieldValue raw = view_.raw(static_cast<std::int32_t>(x), static_cast<std::int32_t>(y));
        if ((raw & kSeen) != 0) {
            sum += static_cast<double>(rays_.weight[i]) * static_cast<double>(raw & kSumMask);
            seen += static_cast<double>(rays_.weight[i]);
        }
    }
    constexpr double kLeastSeen = 0.2;
    return seen > kLeastSeen * weight_sum_ ? sum / (kFieldScale * seen) : -1.0;
}

double MatchObjective::pull(const Pose2& P_map_base) const {
    double squared =
        translation_precision_ * (square(P_map_base.x_m - observed_.x_m) + square(P_map_base.y_m - observed_.y_m));
    if (rotation_precision_ > 0.0) {
        squared += rotation_precision_ * square(wrap_angle(P_map_base.theta_rad - observed_.theta_rad));
    }
    return pull_weight_ * squared / (1.0 + squared / pull_saturation_);
}

double MatchObjective::pull_curvature(const Pose2& P_map_base) const {
    const double squared =
        translation_precision_ * (square(P_map_base.x_m - observed_.x_m) + square(P_map_base.y_m - observed_.y_m));
    return pull_weight_ * translation_precision_ / square(1.0 + squared / pull_saturation_);
}

MatchObjective::Linearized MatchObjective::linearize(const Pose2& P_map_base) const {
    const SlopeSums sums = slope_sum_(view_, rays_, view_.place(P_map_base, cells_per_metre_));
    const double mean = 1.0 / weight_sum_;
    // Back to the map frame and to metres.
    const SinCos r = sin_cos(P_map_base.theta_rad);
    const double per_m = cells_per_metre_;
    const auto turned = [&r, scale = mean * per_m](double x, double y) {
        return std::array<double, 2>{scale * (r.cos * x - r.sin * y), scale * (r.sin * x + r.cos * y)};
    };
    const auto slope = turned(sums.x, sums.y);
    const auto missing = turned(sums.miss_x, sums.miss_y);
    const auto with_turn = turned(sums.xt, sums.yt);
    const double cc = square(r.cos);
    const double ss = square(r.sin);
    const double cs = r.cos * r.sin;
    const double squares = mean * square(per_m);
    const double both = sums.xx + sums.yy;
    return {.match = mean * sums.f,
            .slope = {slope[0], slope[1], mean * sums.t},
            .missing = {missing[0], missing[1], mean * sums.miss_t},
            .information = {.xx = squares * (cc * sums.xx - 2.0 * cs * sums.xy + ss * sums.yy),
                            .xy = squares * (cs * (sums.xx - sums.yy) + (cc - ss) * sums.xy),
                            .yy = squares * (ss * sums.xx + 2.0 * cs * sums.xy + cc * sums.yy),
                            .xt = with_turn[0],
                            .yt = with_turn[1],
                            .tt = mean * sums.tt},
            .steepness = both > 0.0 ? square_root(sums.fourth / both) : 0.0};
}

}  // namespace crspf
