#include "core/slam/match_objective.hpp"

#include <algorithm>

#include "core/base/real.hpp"

namespace crspf {
namespace {

// Vectors of the compiler's: element by element as IEEE 754 has it, on any processor.
using Lanes [[gnu::vector_size(16)]] = float;
using WholeLanes [[gnu::vector_size(16)]] = std::int32_t;

Lanes load_lanes(const float* from) {
    Lanes lanes;
    __builtin_memcpy(&lanes, from, sizeof lanes);
    return lanes;
}

}  // namespace

MatchObjective::MatchObjective(const SlamParams& params, Kernel kernel)
    : pull_weight_(params.particle_filter.pull_weight),
      pull_saturation_(params.particle_filter.pull_saturation),
      critical_weight_(params.critical_rays.weight),
      cells_per_metre_(1.0 / params.map.resolution_m),
      sum_(field_sum_kernel(kernel)) {}

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
                x_[used] = x;
                y_[used] = y;
                weight_[used] = kind ? static_cast<float>(critical_weight_) : 1.0F;
                normal_x_[used] = kind ? 0.0F : normals.x(i);
                normal_y_[used] = kind ? 0.0F : normals.y(i);
                free_[used] = normal_x_[used] == 0.0F && normal_y_[used] == 0.0F ? 1.0F : 0.0F;
                ++used;
            }
        }
        return FieldPoints{.x = x_.data() + begin, .y = y_.data() + begin, .count = used - begin};
    };
    critical_ = take(true);
    ordinary_ = take(false);
    for (std::uint32_t i = used; i % kLanes != 0; ++i) {
        x_[i] = y_[i] = weight_[i] = normal_x_[i] = normal_y_[i] = free_[i] = 0.0F;
    }
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
            sum += static_cast<double>(weight_[i]) * static_cast<double>(raw & kSumMask);
            seen += static_cast<double>(weight_[i]);
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
    const FieldPose pose = view_.place(P_map_base, cells_per_metre_);
    // A cell's value stands for its centre: half a cell back, and the whole part names the lower left of four centres.
    const float at_x = pose.x - 0.5F;
    const float at_y = pose.y - 0.5F;
    constexpr auto kUnit = static_cast<float>(1.0 / kFieldMax);
    // Four rays at a time, each lane with its own sums: every processor adds in the same order.
    enum Sum : std::uint8_t { kF, kX, kY, kT, kMissX, kMissY, kMissT, kXX, kXY, kYY, kXT, kYT, kTT, kFourth, kSums };
    std::array<Lanes, kSums> sums{};
    for (std::uint32_t i = 0; i < rays(); i += kLanes) {
        const Lanes px = load_lanes(&x_[i]);
        const Lanes py = load_lanes(&y_[i]);
        const Lanes x = (pose.cos * px - pose.sin * py) + at_x;
        const Lanes y = (pose.sin * px + pose.cos * py) + at_y;
        const auto ix = __builtin_convertvector(x, WholeLanes);
        const auto iy = __builtin_convertvector(y, WholeLanes);
        const Lanes u = x - __builtin_convertvector(ix, Lanes);
        const Lanes v = y - __builtin_convertvector(iy, Lanes);
        WholeLanes lower{};
        WholeLanes upper{};
        for (std::uint32_t k = 0; k < kLanes; ++k) {
            const FieldView::Square around = view_.square(ix[k], iy[k]);
            lower[k] = static_cast<std::int32_t>(around.lower);
            upper[k] = static_cast<std::int32_t>(around.upper);
        }
        constexpr std::int32_t kLeft = kSumMask;
        const auto lower_left = __builtin_convertvector(lower & kLeft, Lanes);
        const auto upper_left = __builtin_convertvector(upper & kLeft, Lanes);
        const Lanes right_below = __builtin_convertvector(lower >> 16, Lanes) - lower_left;
        const Lanes right_above = __builtin_convertvector(upper >> 16, Lanes) - upper_left;
        const Lanes below = lower_left + u * right_below;
        const Lanes above = upper_left + u * right_above;
        const Lanes f = kUnit * (below + v * (above - below));
        const Lanes fx = kUnit * (right_below + v * (right_above - right_below));
        const Lanes fy = kUnit * (above - below);
        // In base_link, where the normals are; only across the surface.
        const Lanes bx = pose.cos * fx + pose.sin * fy;
        const Lanes by = pose.cos * fy - pose.sin * fx;
        const Lanes normal_x = load_lanes(&normal_x_[i]);
        const Lanes normal_y = load_lanes(&normal_y_[i]);
        const Lanes free = load_lanes(&free_[i]);
        const Lanes across = bx * normal_x + by * normal_y;
        const Lanes gx = free * bx + across * normal_x;
        const Lanes gy = free * by + across * normal_y;
        const Lanes gt = px * gy - py * gx;
        const Lanes a = load_lanes(&weight_[i]);
        const Lanes miss = a * (1.0F - f);
        const Lanes ax = a * gx;
        const Lanes ay = a * gy;
        const Lanes at = a * gt;
        const Lanes squared = gx * gx + gy * gy;
        sums[kF] += a * f;
        sums[kX] += ax;
        sums[kY] += ay;
        sums[kT] += at;
        sums[kMissX] += miss * gx;
        sums[kMissY] += miss * gy;
        sums[kMissT] += miss * gt;
        sums[kXX] += ax * gx;
        sums[kXY] += ax * gy;
        sums[kYY] += ay * gy;
        sums[kXT] += ax * gt;
        sums[kYT] += ay * gt;
        sums[kTT] += at * gt;
        sums[kFourth] += a * (squared * squared);
    }
    const double mean = 1.0 / weight_sum_;
    const auto total = [&sums, mean](Sum which) {
        double sum = 0.0;
        for (std::uint32_t k = 0; k < kLanes; ++k) {
            sum += static_cast<double>(sums[which][k]);
        }
        return sum * mean;
    };
    // Back to the map frame and to metres.
    const SinCos r = sin_cos(P_map_base.theta_rad);
    const double per_m = cells_per_metre_;
    const auto turned = [&r](double x, double y) {
        return std::array<double, 2>{r.cos * x - r.sin * y, r.sin * x + r.cos * y};
    };
    const auto slope = turned(total(kX), total(kY));
    const auto missing = turned(total(kMissX), total(kMissY));
    const auto with_turn = turned(total(kXT), total(kYT));
    const double xx = total(kXX);
    const double xy = total(kXY);
    const double yy = total(kYY);
    const double cc = square(r.cos);
    const double ss = square(r.sin);
    const double cs = r.cos * r.sin;
    return {.match = total(kF),
            .slope = {slope[0] * per_m, slope[1] * per_m, total(kT)},
            .missing = {missing[0] * per_m, missing[1] * per_m, total(kMissT)},
            .information = {.xx = square(per_m) * (cc * xx - 2.0 * cs * xy + ss * yy),
                            .xy = square(per_m) * (cs * (xx - yy) + (cc - ss) * xy),
                            .yy = square(per_m) * (ss * xx + 2.0 * cs * xy + cc * yy),
                            .xt = per_m * with_turn[0],
                            .yt = per_m * with_turn[1],
                            .tt = total(kTT)},
            .steepness = xx + yy > 0.0 ? square_root(total(kFourth) / (xx + yy)) : 0.0};
}

}  // namespace crspf
