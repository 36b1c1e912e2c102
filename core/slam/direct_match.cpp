#include "core/slam/direct_match.hpp"

#include <algorithm>
#include <cstdint>

namespace crspf {
namespace {

constexpr std::int32_t distance(std::int32_t d) {
    return d < 0 ? -d : d;
}

/// The inner sums of (10), times 3 so that delta = 1, 2/3, 1/3 are whole: sum over k of delta_k times the pixels of
/// ring k around `middle`.
std::int64_t block_sum(const OccupancyMap& map, Cell middle) {
    std::int64_t sum = 0;
    for (std::int32_t dy = -kBlockReach; dy <= kBlockReach; ++dy) {
        for (std::int32_t dx = -kBlockReach; dx <= kBlockReach; ++dx) {
            const auto k = static_cast<std::size_t>(std::max(distance(dx), distance(dy)));
            sum += std::int64_t{kRingWeight[k]} * pixel(map.at({.x = middle.x + dx, .y = middle.y + dy}));
        }
    }
    return sum;
}

std::int64_t sum_over(const OccupancyMap& map, const FieldPoints& points, const FieldPose& pose, Cell corner) {
    std::int64_t sum = 0;
    for (std::uint32_t i = 0; i < points.count; ++i) {
        const float x = (pose.cos * points.x[i] - pose.sin * points.y[i]) + pose.x;
        const float y = (pose.sin * points.x[i] + pose.cos * points.y[i]) + pose.y;
        const Cell cell{.x = corner.x + static_cast<std::int32_t>(x), .y = corner.y + static_cast<std::int32_t>(y)};
        sum += block_sum(map, cell);
    }
    return sum;
}

}  // namespace

double direct_match(const OccupancyMap& map, const FieldPoints& critical, const FieldPoints& ordinary,
                    double critical_weight, const Pose2& P_map_base, double cells_per_metre) {
    const double weight_sum =
        critical_weight * static_cast<double>(critical.count) + static_cast<double>(ordinary.count);
    if (!(weight_sum > 0.0)) {
        return 0.0;
    }
    const Cell robot{.x = floor_to_cell(P_map_base.x_m * cells_per_metre),
                     .y = floor_to_cell(P_map_base.y_m * cells_per_metre)};
    constexpr std::int32_t kHalfWindow = FieldView::kTiles / 2 * TileGeometry::kSide;
    FieldView view;
    view.corner = {.x = (robot.x & ~TileGeometry::kMask) - kHalfWindow,
                   .y = (robot.y & ~TileGeometry::kMask) - kHalfWindow};
    const FieldPose pose = view.place(P_map_base, cells_per_metre);
    const double sum = critical_weight * static_cast<double>(sum_over(map, critical, pose, view.corner)) +
                       static_cast<double>(sum_over(map, ordinary, pose, view.corner));
    return sum / (kFieldScale * weight_sum);
}

}  // namespace crspf
