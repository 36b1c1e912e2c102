#include "core/slam/search_grid.hpp"

#include <algorithm>

namespace crspf {
namespace {

std::int32_t rounded_up(std::int32_t cells, std::int32_t cells_per_side) {
    const std::int32_t coarse = (cells + cells_per_side - 1) / cells_per_side;
    return (coarse + SearchGrid::kBlock - 1) / SearchGrid::kBlock * SearchGrid::kBlock;
}

struct Sizes {
    std::size_t cells;
    std::size_t blocks;
};

Sizes sizes_of(std::int32_t width, std::int32_t height) {
    const auto columns = static_cast<std::size_t>(width / SearchGrid::kBlock) + 1;
    const auto rows = static_cast<std::size_t>(height / SearchGrid::kBlock) + 1;
    return {.cells = static_cast<std::size_t>(width) * static_cast<std::size_t>(height),
            .blocks = columns * rows * SearchGrid::kPhases};
}

bool is_map(const MapView& map, std::int32_t cells_per_side) {
    constexpr std::int32_t kMost = 1 << 20;  // [cells] of a side
    return cells_per_side > 0 && map.width > 0 && map.height > 0 && map.width <= kMost && map.height <= kMost &&
           map.cells.size() == static_cast<std::size_t>(map.width) * static_cast<std::size_t>(map.height);
}

}  // namespace

std::size_t SearchGrid::bytes_needed(const MapView& map, std::int32_t cells_per_side) {
    if (!is_map(map, cells_per_side)) {
        return 0;
    }
    const Sizes sizes = sizes_of(rounded_up(map.width, cells_per_side), rounded_up(map.height, cells_per_side));
    return 2 * (sizes.cells + sizes.blocks);
}

bool SearchGrid::build(const MapView& map, std::int32_t cells_per_side, std::span<std::uint8_t> memory) {
    width_ = 0;
    height_ = 0;
    if (!is_map(map, cells_per_side) || memory.size() < bytes_needed(map, cells_per_side)) {
        return false;
    }
    width_ = rounded_up(map.width, cells_per_side);
    height_ = rounded_up(map.height, cells_per_side);
    block_columns_ = width_ / kBlock + 1;
    block_rows_ = height_ / kBlock + 1;
    const Sizes sizes = sizes_of(width_, height_);
    hit_ = memory.data();
    free_ = hit_ + sizes.cells;
    hit_blocks_ = free_ + sizes.cells;
    free_blocks_ = hit_blocks_ + sizes.blocks;
    std::fill_n(hit_, 2 * sizes.cells, std::uint8_t{0});
    fill_cells(map, cells_per_side);
    soften_walls();
    pool(Layer::kHit, hit_blocks_);
    pool(Layer::kFree, free_blocks_);
    return true;
}

void SearchGrid::fill_cells(const MapView& map, std::int32_t cells_per_side) {
    const Evidence* cell = map.cells.data();
    for (std::int32_t y = 0; y < map.height; ++y) {
        const std::ptrdiff_t row = std::ptrdiff_t{y / cells_per_side} * width_;
        for (std::int32_t x = 0; x < map.width; ++x, ++cell) {
            if (*cell != kUnseen) {
                // In one expression with the index, g++ 12's -fsanitize=undefined loses the pointer.
                std::uint8_t* const layer = *cell >= kOccupiedFrom ? hit_ : free_;
                layer[row + x / cells_per_side] = kWorth;
            }
        }
    }
    const std::ptrdiff_t cells = std::ptrdiff_t{width_} * height_;
    for (std::ptrdiff_t i = 0; i < cells; ++i) {
        free_[i] = hit_[i] != 0 ? std::uint8_t{0} : free_[i];
    }
}

void SearchGrid::soften_walls() {
    for (std::int32_t y = 0; y < height_; ++y) {
        for (std::int32_t x = 0; x < width_; ++x) {
            if (hit_[std::ptrdiff_t{y} * width_ + x] != kWorth) {
                continue;
            }
            for (std::int32_t v = std::max(y - 1, 0); v <= std::min(y + 1, height_ - 1); ++v) {
                for (std::int32_t u = std::max(x - 1, 0); u <= std::min(x + 1, width_ - 1); ++u) {
                    std::uint8_t& beside = hit_[std::ptrdiff_t{v} * width_ + u];
                    beside = std::max(beside, std::uint8_t{kWorth / 2});
                }
            }
        }
    }
}

void SearchGrid::pool(Layer layer, std::uint8_t* to) const {
    for (std::int32_t phase = 0; phase < static_cast<std::int32_t>(kPhases); ++phase) {
        for (std::int32_t by = -1; by < height_ / kBlock; ++by) {
            for (std::int32_t bx = -1; bx < width_ / kBlock; ++bx) {
                const std::int32_t left = bx * kBlock + (phase & (kBlock - 1));
                const std::int32_t low = by * kBlock + (phase >> kBlockShift);
                int most = 0;
                for (std::int32_t y = low; y < low + kBlock; ++y) {
                    for (std::int32_t x = left; x < left + kBlock; ++x) {
                        most = std::max(most, at(layer, x, y));
                    }
                }
                *to++ = static_cast<std::uint8_t>(most);
            }
        }
    }
}

}  // namespace crspf
