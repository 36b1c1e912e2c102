#include "core/slam/match_field.hpp"

#include <algorithm>

namespace crspf {
namespace {

constexpr int ring(int dx, int dy) {
    return std::max(dx < 0 ? -dx : dx, dy < 0 ? -dy : dy);
}

constexpr int kBlockSide = 2 * kBlockReach + 1;
/// A kernel row is padded to this, so that adding it is one vector operation on most processors.
constexpr int kRowLanes = 8;

/// Three times the kernel, row by row, padded with zeros.
constexpr auto make_kernel() {
    std::array<std::array<FieldValue, kRowLanes>, kBlockSide> kernel{};
    int dy = -kBlockReach;
    for (auto& row : kernel) {
        for (int dx = -kBlockReach; dx <= kBlockReach; ++dx) {
            const int column = dx + kBlockReach;
            row[static_cast<std::size_t>(column)] =
                static_cast<FieldValue>(kRingWeight[static_cast<std::size_t>(ring(dx, dy))]);
        }
        ++dy;
    }
    return kernel;
}

constexpr auto kKernel = make_kernel();

}  // namespace

FieldPose FieldView::place(const Pose2& P_map_base, double cells_per_metre) const {
    const SinCos r = sin_cos(P_map_base.theta_rad);
    return {.cos = static_cast<float>(r.cos),
            .sin = static_cast<float>(r.sin),
            .x = static_cast<float>(P_map_base.x_m * cells_per_metre - static_cast<double>(corner.x)),
            .y = static_cast<float>(P_map_base.y_m * cells_per_metre - static_cast<double>(corner.y))};
}

void MatchField::follow(std::span<const CellChange> changes) {
    for (const CellChange& change : changes) {
        if (change.before == kUnseen) {
            if (auto* tile = field_.touch(change.cell)) {
                tile->cells[TileGeometry::offset(change.cell)] |= kSeen;
            }
        }
        const int difference = pixel(change.after) - pixel(change.before);
        if (difference != 0) {
            add_block(change.cell, difference);
        }
    }
}

void MatchField::add_block(Cell middle, int difference) {
    // Modulo 2^16, so that a difference below zero subtracts; the sums themselves stay within 15 bits.
    const auto factor = static_cast<FieldValue>(difference);
    const std::int32_t x = middle.x & TileGeometry::kMask;
    const std::int32_t y = middle.y & TileGeometry::kMask;
    const bool inner = x >= kBlockReach && x <= TileGeometry::kSide - kRowLanes + kBlockReach && y >= kBlockReach &&
                       y < TileGeometry::kSide - kBlockReach;
    if (inner) {
        auto* tile = field_.touch(middle);
        if (tile == nullptr) {
            return;
        }
        FieldValue* row = tile->cells.data() + TileGeometry::offset({.x = x - kBlockReach, .y = y - kBlockReach});
        for (const auto& weights : kKernel) {
            for (std::size_t i = 0; i < kRowLanes; ++i) {
                row[i] = static_cast<FieldValue>(row[i] + factor * weights[i]);
            }
            row += TileGeometry::kSide;
        }
        return;
    }
    for (int dy = -kBlockReach; dy <= kBlockReach; ++dy) {
        for (int dx = -kBlockReach; dx <= kBlockReach; ++dx) {
            const Cell cell{.x = middle.x + dx, .y = middle.y + dy};
            if (auto* tile = field_.touch(cell)) {
                FieldValue& value = tile->cells[TileGeometry::offset(cell)];
                value = static_cast<FieldValue>(value + factor * kRingWeight[static_cast<std::size_t>(ring(dx, dy))]);
            }
        }
    }
}

bool MatchField::view_around(Cell robot, FieldView& view) const {
    constexpr std::int32_t kHalfWindow = FieldView::kTiles / 2 * TileGeometry::kSide;
    const Cell corner{.x = (robot.x & ~TileGeometry::kMask) - kHalfWindow,
                      .y = (robot.y & ~TileGeometry::kMask) - kHalfWindow};
    constexpr std::int32_t kLast = TileGeometry::kHalf - 2 * kHalfWindow;
    if (corner.x < -TileGeometry::kHalf || corner.y < -TileGeometry::kHalf || corner.x > kLast || corner.y > kLast) {
        return false;
    }
    view.directory = field_.directory() + TileGeometry::slot(corner);
    view.pool = field_.pool()->cells.data();
    view.corner = corner;
    return true;
}

std::uint32_t field_sum_portable(const FieldView& view, const FieldPoints& points, const FieldPose& pose) {
    std::uint32_t sum = 0;
    for (std::uint32_t i = 0; i < points.count; ++i) {
        // The order of the operations is part of the contract: the vector kernels round alike.
        const float x = (pose.cos * points.x[i] - pose.sin * points.y[i]) + pose.x;
        const float y = (pose.sin * points.x[i] + pose.cos * points.y[i]) + pose.y;
        sum += static_cast<std::uint32_t>(view.value(static_cast<std::int32_t>(x), static_cast<std::int32_t>(y)));
    }
    return sum;
}

FieldSum field_sum_kernel(Kernel kernel) {
#if defined(__x86_64__)
    if (kernel == Kernel::kFastest && static_cast<bool>(__builtin_cpu_supports("avx2"))) {
        return field_sum_avx2;
    }
#else
    static_cast<void>(kernel);
#endif
    return field_sum_portable;
}

}  // namespace crspf
