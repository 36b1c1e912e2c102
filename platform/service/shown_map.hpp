// The map for who looks at it: tiles in percent, each with the number of its last change, so that any number of
// readers get what has changed since they asked last.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <map>

#include "core/slam/occupancy.hpp"
#include "core/slam/tile_grid.hpp"

namespace crspf {

struct TileImage {
    static constexpr std::uint8_t kUnseen = 255;
    Cell corner;  ///< its lowest cell
    /// [percent] how likely each cell is taken, 0 to 100; kUnseen. In TileGeometry::offset()'s order.
    std::array<std::uint8_t, TileGeometry::kCells> cells{};
};

/// A wall from 50 on, as export_map() has it.
[[nodiscard]] constexpr std::uint8_t percent_of(Evidence e) {
    return e == kUnseen ? TileImage::kUnseen
                        : static_cast<std::uint8_t>((e - kFreeCell) * 100 / (kOccupiedCell - kFreeCell));
}
static_assert(percent_of(kOccupiedFrom) == 50 && percent_of(kOccupiedFrom - 1) == 49);

[[nodiscard]] TileImage image_of(Cell corner, const TileCells& cells);

/// One owner. 4 KiB a tile. Changes are numbered from 1 on and for ever; a reader is the number of the last one that it
/// has had, 0 at first.
class ShownMap {
 public:
    /// Another map: all tiles are forgotten, which is a change.
    void begin();
    /// Cells that the image has not seen stay what they were: a part of a tile may be known to the keeper of far ones
    /// alone. Nothing where that changes nothing, or outside the plane.
    void take(const TileImage& image);

    /// The number of the last change.
    [[nodiscard]] std::uint64_t version() const { return version_; }
    [[nodiscard]] bool empty() const { return tiles_.empty(); }

    /// Whether the reader knows nothing of this map, or of another one. It is at its beginning afterwards.
    [[nodiscard]] bool fresh_for(std::uint64_t& reader) const;
    /// The tile whose change is the next after the reader's, which moves on; nullptr: there is none.
    [[nodiscard]] const TileImage* next(std::uint64_t& reader) const;
    /// In no order.
    template <class Visitor>
    void for_each_tile(const Visitor& visit) const {
        for (const auto& [slot, tile] : tiles_) {
            visit(tile.image);
        }
    }

 private:
    struct Tile {
        std::uint64_t change = 0;
        TileImage image;
    };

    std::map<std::size_t, Tile> tiles_;               ///< by TileGeometry::slot()
    std::map<std::uint64_t, const Tile*> by_change_;  ///< the last one of each
    std::uint64_t version_ = 0;
    std::uint64_t begun_ = 0;  ///< the change by which this map began
};

}  // namespace crspf
