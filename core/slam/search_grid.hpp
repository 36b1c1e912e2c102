// A map as the search for a lost robot wants it: coarse cells, and for each the best of the block of 4 x 4 that begins
// there, so that one sum bounds 16 poses.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "core/slam/map_view.hpp"

namespace crspf {

/// What a point of a scan is worth in a cell: two layers, for the two kinds of points.
enum class Layer : std::uint8_t {
    kHit,   ///< where a beam ended: kWorth on a wall, half beside one
    kFree,  ///< where a beam passed: kWorth where the map is free
};
inline constexpr std::uint8_t kWorth = 4;

/// Coarse cells over a MapView, in its frame, counted from its corner. Occupied: one of the map's cells in it is.
/// Free: one is free and none occupied. Kept in memory of the caller. No heap, no throw. One owner.
class SearchGrid {
 public:
    static constexpr int kBlockShift = 2;
    static constexpr std::int32_t kBlock = 1 << kBlockShift;
    static constexpr std::size_t kPhases = std::size_t{1} << (2 * kBlockShift);

    /// Bytes that build() needs for a map.
    [[nodiscard]] static std::size_t bytes_needed(const MapView& map, std::int32_t cells_per_side);
    /// @param cells_per_side how many of the map's cells make a coarse one along each axis
    /// False: no map, or `memory` holds less than bytes_needed(). Linear in the map's cells.
    [[nodiscard]] bool build(const MapView& map, std::int32_t cells_per_side, std::span<std::uint8_t> memory);

    [[nodiscard]] std::int32_t width() const { return width_; }    ///< [cells] a multiple of kBlock
    [[nodiscard]] std::int32_t height() const { return height_; }  ///< [cells] a multiple of kBlock

    /// The worth in a cell; 0 outside.
    [[nodiscard]] int at(Layer layer, std::int32_t x, std::int32_t y) const {
        const bool inside = static_cast<std::uint32_t>(x) < static_cast<std::uint32_t>(width_) &&
                            static_cast<std::uint32_t>(y) < static_cast<std::uint32_t>(height_);
        return inside ? leaf(layer)[y * width_ + x] : 0;
    }
    /// Whether a lidar can be in the cell.
    [[nodiscard]] bool can_stand(std::int32_t x, std::int32_t y) const { return at(Layer::kFree, x, y) != 0; }

    /// Block (bx, by) of phase (px, py) holds the most of cells (kBlock bx + px, kBlock by + py) to 3 above and right
    /// of it. A row runs from block -1 to width() / kBlock - 1; the pointer is to block -1.
    [[nodiscard]] const std::uint8_t* block_row(Layer layer, std::int32_t phase, std::int32_t by) const {
        return blocks(layer) + (phase * block_rows_ + (by + 1)) * block_columns_;
    }

 private:
    [[nodiscard]] const std::uint8_t* leaf(Layer layer) const { return layer == Layer::kHit ? hit_ : free_; }
    [[nodiscard]] const std::uint8_t* blocks(Layer layer) const {
        return layer == Layer::kHit ? hit_blocks_ : free_blocks_;
    }
    void fill_cells(const MapView& map, std::int32_t cells_per_side);
    void soften_walls();
    void pool(Layer layer, std::uint8_t* to) const;

    std::int32_t width_ = 0;
    std::int32_t height_ = 0;
    std::ptrdiff_t block_rows_ = 0;     ///< stored: one more below
    std::ptrdiff_t block_columns_ = 0;  ///< stored: one more to the left
    std::uint8_t* hit_ = nullptr;
    std::uint8_t* free_ = nullptr;
    std::uint8_t* hit_blocks_ = nullptr;
    std::uint8_t* free_blocks_ = nullptr;
};

}  // namespace crspf
