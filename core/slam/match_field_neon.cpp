// The NEON kernel of the match field, for 64-bit ARM, which always has NEON, and for 32-bit ARM built with it.
//
// NEON of 32-bit ARM takes numbers below 2^-126 for zero and gives zero for them, which IEEE 754 does not. That makes
// no difference here. A view is laid around the robot, so a pose's x and y are about half its window, 2^12, and a point
// is placed a cell or more from zero. A product that is lost is below 2^-126. Where the other product is at least
// 2^-101 it is less than half of that one's last place, and would be rounded away; where that is less, too, the pose
// swallows the sum of both, whatever it is.
#if defined(__ARM_NEON)

#include <arm_neon.h>

#include "core/slam/match_field.hpp"

namespace crspf {
namespace {

/// Points for one instruction.
constexpr std::uint32_t kQuad = 4;

}  // namespace

std::uint32_t field_sum_neon(const FieldView& view, const FieldPoints& points, const FieldPose& pose) {
    constexpr std::uint32_t kLanes = kPointLanes;
    const float32x4_t cos = vdupq_n_f32(pose.cos);
    const float32x4_t sin = vdupq_n_f32(pose.sin);
    const float32x4_t at_x = vdupq_n_f32(pose.x);
    const float32x4_t at_y = vdupq_n_f32(pose.y);
    const int32x4_t mask = vdupq_n_s32(TileGeometry::kMask);
    constexpr int kShift = TileGeometry::kShift;
    constexpr int kDirectoryShift = 10;
    static_assert(TileGeometry::kDirectorySide == 1 << kDirectoryShift);
    std::uint32_t sum_a = 0;
    std::uint32_t sum_b = 0;
    for (std::uint32_t i = 0; i < points.count; i += kLanes) {
        // NOLINTBEGIN(cppcoreguidelines-pro-type-member-init): stored to at once
        std::array<std::int32_t, kLanes> slot;
        std::array<std::int32_t, kLanes> offset;
        // NOLINTEND(cppcoreguidelines-pro-type-member-init)
        for (std::uint32_t lane = 0; lane < kLanes; lane += kQuad) {
            const float32x4_t px = vld1q_f32(points.x + i + lane);
            const float32x4_t py = vld1q_f32(points.y + i + lane);
            // Products and sums apart: vmlaq would be fused, and round once.
            const float32x4_t x = vaddq_f32(vsubq_f32(vmulq_f32(cos, px), vmulq_f32(sin, py)), at_x);
            const float32x4_t y = vaddq_f32(vaddq_f32(vmulq_f32(sin, px), vmulq_f32(cos, py)), at_y);
            const int32x4_t ix = vcvtq_s32_f32(x);
            const int32x4_t iy = vcvtq_s32_f32(y);
            vst1q_s32(slot.data() + lane,
                      vaddq_s32(vshlq_n_s32(vshrq_n_s32(iy, kShift), kDirectoryShift), vshrq_n_s32(ix, kShift)));
            vst1q_s32(offset.data() + lane, vorrq_s32(vshlq_n_s32(vandq_s32(iy, mask), kShift), vandq_s32(ix, mask)));
        }
        const auto look_up = [&view, &slot, &offset](std::size_t lane) {
            const std::size_t tile = static_cast<std::size_t>(view.directory[slot[lane]]) << (2 * kShift);
            return static_cast<std::uint32_t>(view.pool[tile + static_cast<std::size_t>(offset[lane])] & kSumMask);
        };
        const std::uint32_t lanes = points.count - i;
        if (lanes >= kLanes) {
            sum_a += look_up(0) + look_up(2) + look_up(4) + look_up(6);
            sum_b += look_up(1) + look_up(3) + look_up(5) + look_up(7);
            continue;
        }
        for (std::uint32_t lane = 0; lane < lanes; ++lane) {
            sum_a += look_up(lane);
        }
    }
    return sum_a + sum_b;
}

}  // namespace crspf

#endif
