#include "core/slam/match_slopes.hpp"

namespace crspf {
namespace {

constexpr std::uint32_t kLanes = RayTable::kLanes;

// Vectors of the compiler's: element by element as IEEE 754 has it, on any processor. Each lane has its own sums, so
// that every processor adds in the same order.
using Lanes [[gnu::vector_size(kLanes * sizeof(float))]] = float;
using WholeLanes [[gnu::vector_size(kLanes * sizeof(std::int32_t))]] = std::int32_t;

double total(const Lanes& lanes) {
    double sum = 0.0;
    for (std::uint32_t k = 0; k < kLanes; ++k) {
        sum += static_cast<double>(lanes[k]);
    }
    return sum;
}

// Inlined into each kernel and compiled for its processor.
[[gnu::always_inline]] inline SlopeSums add_up(const FieldView& view, const RayTable& rays, const FieldPose& pose) {
    // A cell's value stands for its centre: half a cell back, and the whole part names the lower left of four centres.
    const float at_x = pose.x - 0.5F;
    const float at_y = pose.y - 0.5F;
    constexpr int kShift = TileGeometry::kShift;
    constexpr std::int32_t kMask = TileGeometry::kMask;
    constexpr auto kUnit = static_cast<float>(1.0 / kFieldMax);
    Lanes sum_f{};
    Lanes sum_x{};
    Lanes sum_y{};
    Lanes sum_t{};
    Lanes sum_miss_x{};
    Lanes sum_miss_y{};
    Lanes sum_miss_t{};
    Lanes sum_xx{};
    Lanes sum_xy{};
    Lanes sum_yy{};
    Lanes sum_xt{};
    Lanes sum_yt{};
    Lanes sum_tt{};
    Lanes sum_fourth{};
    for (std::uint32_t i = 0; i < rays.count; i += kLanes) {
        Lanes px;
        Lanes py;
        Lanes normal_x;
        Lanes normal_y;
        Lanes free;
        Lanes a;
        __builtin_memcpy(&px, &rays.x[i], sizeof px);
        __builtin_memcpy(&py, &rays.y[i], sizeof py);
        __builtin_memcpy(&normal_x, &rays.normal_x[i], sizeof normal_x);
        __builtin_memcpy(&normal_y, &rays.normal_y[i], sizeof normal_y);
        __builtin_memcpy(&free, &rays.free[i], sizeof free);
        __builtin_memcpy(&a, &rays.weight[i], sizeof a);
        const Lanes x = (pose.cos * px - pose.sin * py) + at_x;
        const Lanes y = (pose.sin * px + pose.cos * py) + at_y;
        const auto ix = __builtin_convertvector(x, WholeLanes);
        const auto iy = __builtin_convertvector(y, WholeLanes);
        const Lanes u = x - __builtin_convertvector(ix, Lanes);
        const Lanes v = y - __builtin_convertvector(iy, Lanes);
        const WholeLanes slot = (iy >> kShift) * TileGeometry::kDirectorySide + (ix >> kShift);
        const WholeLanes offset = ((iy & kMask) << kShift) + (ix & kMask);
        const WholeLanes at_edge = ((ix & kMask) == kMask) | ((iy & kMask) == kMask);
        WholeLanes lower{};
        WholeLanes upper{};
        for (std::uint32_t k = 0; k < kLanes; ++k) {
            const FieldView::Square around =
                at_edge[k] != 0 ? view.square_at_edge(ix[k], iy[k]) : view.square_within(slot[k], offset[k]);
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
        const Lanes across = bx * normal_x + by * normal_y;
        const Lanes gx = free * bx + across * normal_x;
        const Lanes gy = free * by + across * normal_y;
        const Lanes gt = px * gy - py * gx;
        const Lanes miss = a * (1.0F - f);
        const Lanes ax = a * gx;
        const Lanes ay = a * gy;
        const Lanes at = a * gt;
        const Lanes squared = gx * gx + gy * gy;
        sum_f += a * f;
        sum_x += ax;
        sum_y += ay;
        sum_t += at;
        sum_miss_x += miss * gx;
        sum_miss_y += miss * gy;
        sum_miss_t += miss * gt;
        sum_xx += ax * gx;
        sum_xy += ax * gy;
        sum_yy += ay * gy;
        sum_xt += ax * gt;
        sum_yt += ay * gt;
        sum_tt += at * gt;
        sum_fourth += a * (squared * squared);
    }
    return {.f = total(sum_f),
            .x = total(sum_x),
            .y = total(sum_y),
            .t = total(sum_t),
            .miss_x = total(sum_miss_x),
            .miss_y = total(sum_miss_y),
            .miss_t = total(sum_miss_t),
            .xx = total(sum_xx),
            .xy = total(sum_xy),
            .yy = total(sum_yy),
            .xt = total(sum_xt),
            .yt = total(sum_yt),
            .tt = total(sum_tt),
            .fourth = total(sum_fourth)};
}

SlopeSums slope_sum_portable(const FieldView& view, const RayTable& rays, const FieldPose& pose) {
    return add_up(view, rays, pose);
}

#if defined(__x86_64__)
[[gnu::target("avx2")]] SlopeSums slope_sum_avx2(const FieldView& view, const RayTable& rays, const FieldPose& pose) {
    return add_up(view, rays, pose);
}
#endif

}  // namespace

SlopeSum slope_sum_kernel(Kernel kernel) {
#if defined(__x86_64__)
    if (takes_avx2(kernel)) {
        return slope_sum_avx2;
    }
#else
    static_cast<void>(kernel);
#endif
    return slope_sum_portable;
}

}  // namespace crspf
