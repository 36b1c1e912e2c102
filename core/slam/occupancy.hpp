// What a map cell holds, and the records by which the map's owner tells the filter what has changed.
#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "config/capacities.hpp"
#include "core/slam/tile_grid.hpp"

namespace crspf {

/// Evidence that a cell is occupied: 0 never seen, 1 free, up to 255 occupied.
using Evidence = std::uint8_t;
inline constexpr Evidence kUnseen = 0;
inline constexpr Evidence kFreeCell = 1;
inline constexpr Evidence kOccupiedCell = 255;
/// Evidence of half or more: a wall, for whoever wants a plain yes or no.
inline constexpr Evidence kOccupiedFrom = 128;

/// c of formula (10): the pixel value, high = occupied. Unknown and free say nothing for a match.
constexpr int pixel(Evidence e) {
    return e > kFreeCell ? e : 0;
}

/// A tile of the map. Beside the cells it counts the free ones in each block of 16 x 16, so that a ray crosses known
/// free space in strides.
struct OccupancyTile {
    static constexpr int kBlockShift = 4;
    static constexpr std::uint16_t kBlockCells = 1U << (2 * kBlockShift);
    static constexpr int kBlocksShift = TileGeometry::kShift - kBlockShift;

    std::array<Evidence, TileGeometry::kCells> cells;
    std::array<std::uint16_t, std::size_t{1} << (2 * kBlocksShift)> free_cells;

    /// Place in free_cells of the block that holds `c`.
    [[nodiscard]] static constexpr std::size_t block(Cell c) {
        const auto x = static_cast<std::size_t>((c.x & TileGeometry::kMask) >> kBlockShift);
        const auto y = static_cast<std::size_t>((c.y & TileGeometry::kMask) >> kBlockShift);
        return (y << kBlocksShift) | x;
    }
};

/// The map: written by the map update only.
using OccupancyMap = TileGrid<OccupancyTile>;

/// One cell has changed.
struct CellChange {
    Cell cell;
    Evidence before = kUnseen;
    Evidence after = kUnseen;
};

using TileCells = std::array<Evidence, TileGeometry::kCells>;

/// A tile has come back from where far ones are kept, or has gone there.
struct TileChange {
    Cell corner;
    bool gone = false;
    TileCells cells{};  ///< what the map gained or lost by it; kUnseen: nothing
};

/// The changes of one map update: tiles that came back, then cells in order, then tiles that went away. Bounded: `add`
/// refuses and counts what does not fit, and the writer then leaves the cell as it was, so that map and match field
/// never part.
class ChangeList {
 public:
    /// Each way.
    static constexpr std::size_t kTilesEachWay = 16;

    [[nodiscard]] bool full() const { return count_ == changes_.size(); }
    [[nodiscard]] bool add(const CellChange& change) {
        if (full()) {
            ++refused_;
            return false;
        }
        changes_[count_++] = change;
        return true;
    }
    /// To be filled in. Only for kTilesEachWay of each kind.
    [[nodiscard]] TileChange& add_tile() { return tiles_[tile_count_++]; }
    void clear() { count_ = tile_count_ = 0; }
    [[nodiscard]] std::span<const CellChange> view() const { return {changes_.data(), count_}; }
    [[nodiscard]] std::span<const TileChange> tiles() const { return {tiles_.data(), tile_count_}; }
    [[nodiscard]] std::uint64_t refused() const { return refused_; }

 private:
    std::size_t count_ = 0;
    std::size_t tile_count_ = 0;
    std::uint64_t refused_ = 0;
    std::array<CellChange, capacity::kCellChanges> changes_;
    std::array<TileChange, 2 * kTilesEachWay> tiles_;
};

}  // namespace crspf
