// A sparse plane of cells: fixed pool of square tiles behind a directory. A corridor costs its length, not its square.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <type_traits>

#include "config/capacities.hpp"

namespace crspf {

/// Integer cell coordinates in the map frame. Cell (x, y) covers [x, x + 1) * [y, y + 1) times the resolution.
struct Cell {
    std::int32_t x = 0;
    std::int32_t y = 0;

    friend bool operator==(const Cell&, const Cell&) = default;
};

/// The cell that holds a coordinate in cells. Only for coordinates that fit 31 bits.
constexpr std::int32_t floor_to_cell(double v) {
    const auto truncated = static_cast<std::int32_t>(v);
    return static_cast<double>(truncated) > v ? truncated - 1 : truncated;
}

/// Geometry that every grid of tiles shares.
struct TileGeometry {
    static constexpr int kShift = capacity::kTileShift;
    static constexpr std::int32_t kSide = 1 << kShift;  ///< [cells] of a tile
    static constexpr std::int32_t kMask = kSide - 1;
    static constexpr std::size_t kCells = std::size_t{1} << (2 * kShift);
    static constexpr std::int32_t kDirectorySide = capacity::kDirectoryTiles;
    /// The directory's middle is cell (0, 0): cells run from -kHalf to kHalf - 1.
    static constexpr std::int32_t kHalf = kDirectorySide * kSide / 2;

    [[nodiscard]] static constexpr bool inside(Cell c) {
        return c.x >= -kHalf && c.x < kHalf && c.y >= -kHalf && c.y < kHalf;
    }
    /// Place of the cell's tile in the directory. Only for cells inside.
    [[nodiscard]] static constexpr std::size_t slot(Cell c) {
        const auto tx = static_cast<std::size_t>((c.x + kHalf) >> kShift);
        const auto ty = static_cast<std::size_t>((c.y + kHalf) >> kShift);
        return ty * static_cast<std::size_t>(kDirectorySide) + tx;
    }
    /// Place of the cell in its tile.
    [[nodiscard]] static constexpr std::size_t offset(Cell c) {
        return (static_cast<std::size_t>(c.y & kMask) << kShift) | static_cast<std::size_t>(c.x & kMask);
    }
};

/// Tiles of type `Tile`, made when first written, kept until release(). A Tile has an array `cells` of kCells values;
/// value-initialised it is empty, and absent cells read as empty ones. It has no default member initialisers, which
/// would write to the whole pool at the start.
/// Every method but next_place and for_each_tile: no heap, no throw, constant time. One owner (not thread-safe).
/// The pool's memory is not touched before a tile is made, so that unused capacity costs address space only.
template <typename Tile>
class TileGrid : public TileGeometry {
 public:
    static_assert(std::is_trivially_default_constructible_v<Tile>);
    using Value = typename decltype(Tile::cells)::value_type;
    /// Index into the pool. Tile 0 is always there and always empty, so that a look-up needs no branch.
    using TileId = std::uint16_t;
    static_assert(capacity::kTiles < 65536, "TileId counts tiles in 16 bits");

    TileGrid() { pool_[0] = Tile{}; }

    /// The value of a cell; empty outside the directory.
    [[nodiscard]] Value at(Cell c) const { return inside(c) ? pool_[directory_[slot(c)]].cells[offset(c)] : Value{}; }

    /// The tile that holds `c`, for writing; nullptr, counted in refused(), outside the directory or when the pool is
    /// used up.
    [[nodiscard]] Tile* touch(Cell c) {
        if (!inside(c)) {
            ++refused_;
            return nullptr;
        }
        TileId& id = directory_[slot(c)];
        if (id == 0) {
            if (full()) {
                ++refused_;
                return nullptr;
            }
            id = released_ > 0 ? free_[--released_] : static_cast<TileId>(used_++);
            corners_[id] = {.x = c.x & ~kMask, .y = c.y & ~kMask};
            pool_[id] = Tile{};
        }
        return &pool_[id];
    }

    /// The tile that holds `c`; nullptr where there is none.
    [[nodiscard]] const Tile* find(Cell c) const {
        const TileId id = inside(c) ? directory_[slot(c)] : TileId{0};
        return id == 0 ? nullptr : &pool_[id];
    }
    /// The tile that holds `c`, if there is one, is empty from now on and its memory free for another.
    void release(Cell c) {
        if (find(c) != nullptr) {
            TileId& id = directory_[slot(c)];
            free_[released_++] = id;
            id = 0;
        }
    }

    /// Tiles that there are; the empty tile is not counted.
    [[nodiscard]] std::size_t tiles() const { return used_ - 1 - released_; }
    /// Whether there is room for no other tile.
    [[nodiscard]] bool full() const { return tiles() == capacity::kTiles - 1; }
    /// Writes refused. Never reset.
    [[nodiscard]] std::uint64_t refused() const { return refused_; }

    [[nodiscard]] const TileId* directory() const { return directory_.data(); }
    [[nodiscard]] const Tile* pool() const { return pool_.data(); }

    /// The first place at or after `place` that holds a tile; places() if there is none. Places are filled in the order
    /// in which tiles are made, those that were released first.
    [[nodiscard]] std::size_t next_place(std::size_t place) const {
        while (place < places() && directory_[slot(corner(place))] != place + 1) {
            ++place;
        }
        return place;
    }
    [[nodiscard]] std::size_t places() const { return used_ - 1; }
    /// The tile in a place that holds one, and its lower-left corner.
    [[nodiscard]] const Tile& tile(std::size_t place) const { return pool_[place + 1]; }
    [[nodiscard]] Cell corner(std::size_t place) const { return corners_[place + 1]; }

    /// Calls `visit(Cell of the tile's lower-left corner, const Tile&)` for each tile, in the order of their places.
    template <typename Visit>
    void for_each_tile(Visit&& visit) const {
        for (std::size_t i = next_place(0); i < places(); i = next_place(i + 1)) {
            visit(corner(i), tile(i));
        }
    }

 private:
    std::size_t used_ = 1;      ///< of the pool, ever
    std::size_t released_ = 0;  ///< of these: they are the first in free_
    std::uint64_t refused_ = 0;
    std::array<TileId, static_cast<std::size_t>(kDirectorySide) * kDirectorySide> directory_{};
    std::array<Cell, capacity::kTiles> corners_{};
    std::array<TileId, capacity::kTiles> free_{};
    alignas(64) std::array<Tile, capacity::kTiles> pool_;  // left alone: see the class comment
};

}  // namespace crspf
