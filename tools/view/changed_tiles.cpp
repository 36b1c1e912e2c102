#include "tools/view/changed_tiles.hpp"

#include <algorithm>

namespace crspf::view {
namespace {

/// What `cells` show, and where they have seen nothing, what was seen `before`.
TileCells laid_over(const TileCells& before, const TileCells& cells) {
    TileCells both;
    std::transform(cells.begin(), cells.end(), before.begin(), both.begin(),
                   [](Evidence cell, Evidence old) { return cell != kUnseen ? cell : old; });
    return both;
}

}  // namespace

TilesEvent ChangedTiles::look(const OccupancyMap& map, TileArchive* far) {
    if (far != nullptr) {
        far->for_each_tile([&](Cell corner, const TileCells& cells) {
            const OccupancyTile* const near = map.find(corner);
            shown_.take(image_of(corner, near != nullptr ? laid_over(cells, near->cells) : cells));
        });
    }
    map.for_each_tile([&](Cell corner, const OccupancyTile& tile) { shown_.take(image_of(corner, tile.cells)); });
    TilesEvent event{.fresh = shown_.fresh_for(told_), .resolution_m = resolution_m_, .tiles = {}};
    while (const TileImage* const tile = shown_.next(told_)) {
        event.tiles.push_back(*tile);
    }
    return event;
}

}  // namespace crspf::view
