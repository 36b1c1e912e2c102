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
/// Where in its row the kernel may begin, so that near the right edge of a tile the padding lies on the left.
constexpr int kStarts = kRowLanes - kBlockSide + 1;

using KernelRow = std::array<FieldValue, kRowLanes>;

/// Three times the kernel, row by row, padded with zeros; for each start.
constexpr auto make_kernels() {
    std::array<std::array<KernelRow, kBlockSide>, kStarts> kernels{};
    std::size_t start = 0;
    for (auto& kernel : kernels) {
        int y = -kBlockReach;
        for (KernelRow& row : kernel) {
            for (int x = -kBlockReach; x <= kBlockReach; ++x) {
                const int column = x + kBlockReach;
                row[start + static_cast<std::size_t>(column)] =
                    static_cast<FieldValue>(kRingWeight[static_cast<std::size_t>(ring(x, y))]);
            }
            ++y;
        }
        ++start;
    }
    return kernels;
}

constexpr auto kKernels = make_kernels();

}  // namespace

FieldPose FieldView::place(const Pose2& P_map_base, double cells_per_metre) const {
    const SinCos r = sin_cos(P_map_base.theta_rad);
    return {.cos = static_cast<float>(r.cos),
            .sin = static_cast<float>(r.sin),
            .x = static_cast<float>(P_map_base.x_m * cells_per_metre - static_cast<double>(corner.x)),
            .y = static_cast<float>(P_map_base.y_m * cells_per_metre - static_cast<double>(corner.y))};
}

FieldView::Square FieldView::square_at_edge(std::int32_t ix, std::int32_t iy) const {
    return {.lower = pair(cell(ix, iy), cell(ix + 1, iy)), .upper = pair(cell(ix, iy + 1), cell(ix + 1, iy + 1))};
}

void MatchField::follow(const ChangeList& changes) {
    for (const TileChange& tile : changes.tiles()) {
        if (!tile.gone) {
            add_tile(tile);
        }
    }
    follow(changes.view());
    for (const TileChange& tile : changes.tiles()) {
        if (tile.gone) {
            remove_tile(tile);
        }
    }
}

void MatchField::add_tile(const TileChange& tile) {
    for (std::int32_t y = 0; y < TileGeometry::kSide; ++y) {
        for (std::int32_t x = 0; x < TileGeometry::kSide; ++x) {
            const Cell cell{.x = tile.corner.x + x, .y = tile.corner.y + y};
            const CellChange change{.cell = cell, .before = kUnseen, .after = tile.cells[TileGeometry::offset(cell)]};
            if (change.after != kUnseen) {
                follow({&change, 1});
            }
        }
    }
}

void MatchField::remove_tile(const TileChange& tile) {
    for (std::int32_t y = 0; y < TileGeometry::kSide; ++y) {
        for (std::int32_t x = 0; x < TileGeometry::kSide; ++x) {
            const Cell cell{.x = tile.corner.x + x, .y = tile.corner.y + y};
            if (const int value = pixel(tile.cells[TileGeometry::offset(cell)]); value != 0) {
                add_block(cell, -value);
            }
        }
    }
    if (field_.find(tile.corner) != nullptr) {
        for (FieldValue& value : field_.touch(tile.corner)->cells) {
            value &= kSumMask;
        }
    }
    // Its walls reached into the tiles around it, and theirs into this one.
    constexpr std::int32_t kSide = TileGeometry::kSide;
    for (std::int32_t y = -kSide; y <= kSide; y += kSide) {
        for (std::int32_t x = -kSide; x <= kSide; x += kSide) {
            release_if_empty({.x = tile.corner.x + x, .y = tile.corner.y + y});
        }
    }
}

void MatchField::release_if_empty(Cell c) {
    const FieldTile* const tile = field_.find(c);
    if (tile != nullptr &&
        std::all_of(tile->cells.begin(), tile->cells.end(), [](FieldValue value) { return value == 0; })) {
        field_.release(c);
    }
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
    const std::int32_t left = (middle.x & TileGeometry::kMask) - kBlockReach;
    const std::int32_t bottom = (middle.y & TileGeometry::kMask) - kBlockReach;
    const auto within = [](std::int32_t low) { return low >= 0 && low <= TileGeometry::kSide - kBlockSide; };
    if (within(left) && within(bottom)) {
        auto* tile = field_.touch(middle);
        if (tile == nullptr) {
            return;
        }
        const std::int32_t begin = std::min(left, TileGeometry::kSide - kRowLanes);
        FieldValue* row = tile->cells.data() + TileGeometry::offset({.x = begin, .y = bottom});
        for (const KernelRow& weights : kKernels[static_cast<std::size_t>(left - begin)]) {
            for (std::size_t i = 0; i < kRowLanes; ++i) {
                row[i] = static_cast<FieldValue>(row[i] + factor * weights[i]);
            }
            row += TileGeometry::kSide;
        }
        return;
    }
    // Across an edge: two tiles, or four.
    constexpr std::int32_t kMask = TileGeometry::kMask;
    const Cell low{.x = middle.x - kBlockReach, .y = middle.y - kBlockReach};
    const Cell high{.x = middle.x + kBlockReach, .y = middle.y + kBlockReach};
    for (Cell from = low; from.y <= high.y; from.y = (from.y | kMask) + 1) {
        for (from.x = low.x; from.x <= high.x; from.x = (from.x | kMask) + 1) {
            auto* tile = field_.touch(from);
            if (tile == nullptr) {
                continue;
            }
            for (Cell c = from; c.y <= std::min(high.y, from.y | kMask); ++c.y) {
                for (c.x = from.x; c.x <= std::min(high.x, from.x | kMask); ++c.x) {
                    const auto weight = static_cast<FieldValue>(
                        kRingWeight[static_cast<std::size_t>(ring(c.x - middle.x, c.y - middle.y))]);
                    FieldValue& value = tile->cells[TileGeometry::offset(c)];
                    value = static_cast<FieldValue>(value + factor * weight);
                }
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
    if (takes_avx2(kernel)) {
        return field_sum_avx2;
    }
#elif defined(__ARM_NEON)
    if (kernel == Kernel::kFastest) {
        return field_sum_neon;
    }
#else
    static_cast<void>(kernel);
#endif
    return field_sum_portable;
}

}  // namespace crspf
