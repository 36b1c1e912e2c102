// The AVX2 kernel of the match field. Only this file is compiled for AVX2; it runs where the processor has it.
#if defined(__x86_64__)

#include <immintrin.h>

#include "core/slam/match_field.hpp"

namespace crspf {

std::uint32_t field_sum_avx2(const FieldView& view, const FieldPoints& points, const FieldPose& pose) {
    constexpr std::uint32_t kLanes = kPointLanes;
    const __m256 cos = _mm256_set1_ps(pose.cos);
    const __m256 sin = _mm256_set1_ps(pose.sin);
    const __m256 at_x = _mm256_set1_ps(pose.x);
    const __m256 at_y = _mm256_set1_ps(pose.y);
    const __m256i mask = _mm256_set1_epi32(TileGeometry::kMask);
    constexpr int kShift = TileGeometry::kShift;
    constexpr int kDirectoryShift = 10;
    static_assert(TileGeometry::kDirectorySide == 1 << kDirectoryShift);
    std::uint32_t sum_a = 0;
    std::uint32_t sum_b = 0;
    for (std::uint32_t i = 0; i < points.count; i += kLanes) {
        const __m256 px = _mm256_loadu_ps(points.x + i);
        const __m256 py = _mm256_loadu_ps(points.y + i);
        const __m256 x = _mm256_add_ps(_mm256_sub_ps(_mm256_mul_ps(cos, px), _mm256_mul_ps(sin, py)), at_x);
        const __m256 y = _mm256_add_ps(_mm256_add_ps(_mm256_mul_ps(sin, px), _mm256_mul_ps(cos, py)), at_y);
        const __m256i ix = _mm256_cvttps_epi32(x);
        const __m256i iy = _mm256_cvttps_epi32(y);
        // NOLINTBEGIN(cppcoreguidelines-pro-type-member-init): stored to at once; zeroing them costs a tenth of the
        // time
        alignas(32) std::array<std::uint32_t, kLanes> slot;
        alignas(32) std::array<std::uint32_t, kLanes> offset;
        // NOLINTEND(cppcoreguidelines-pro-type-member-init)
        // NOLINTBEGIN(cppcoreguidelines-pro-type-reinterpret-cast): the intrinsics' own way to name memory
        _mm256_store_si256(reinterpret_cast<__m256i*>(slot.data()),
                           _mm256_add_epi32(_mm256_slli_epi32(_mm256_srai_epi32(iy, kShift), kDirectoryShift),
                                            _mm256_srai_epi32(ix, kShift)));
        _mm256_store_si256(
            reinterpret_cast<__m256i*>(offset.data()),
            _mm256_or_si256(_mm256_slli_epi32(_mm256_and_si256(iy, mask), kShift), _mm256_and_si256(ix, mask)));
        // NOLINTEND(cppcoreguidelines-pro-type-reinterpret-cast)
        // Single loads, not a gather: on most processors a gather is slower than its loads, and two would be needed.
        const auto look_up = [&view, &slot, &offset](std::size_t lane) {
            const std::size_t tile = static_cast<std::size_t>(view.directory[slot[lane]]) << (2 * kShift);
            return static_cast<std::uint32_t>(view.pool[tile + offset[lane]] & kSumMask);
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
