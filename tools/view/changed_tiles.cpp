#include "tools/view/changed_tiles.hpp"

#include <algorithm>
#include <utility>

#include "platform/service/map_image.hpp"

namespace crspf::view {
namespace {

/// What `cells` show, and where they have seen nothing, what was seen `before`.
TileCells laid_over(const TileCells& before, const TileCells& cells) {
    TileCells both;
    std::transform(cells.begin(), cells.end(), before.begin(), both.begin(),
                   [](Evidence cell, Evidence old) { return cell != kUnseen ? cell : old; });
    return both;
}

TileImage image_of(Cell corner, const TileCells& cells) {
    static_assert(TileImage::kUnseen == kUnseenPercent);
    TileImage image{.corner = corner};
    std::transform(cells.begin(), cells.end(), image.cells.begin(), percent_of);
    return image;
}

}  // namespace

TilesEvent ChangedTiles::look(const OccupancyMap& map, TileArchive* far) {
    TilesEvent event{.fresh = !std::exchange(looked_, true), .resolution_m = resolution_m_, .tiles = {}};
    if (far != nullptr) {
        far->for_each_tile([&](Cell corner, const TileCells& cells) {
            const OccupancyTile* const near = map.find(corner);
            look_at(corner, near != nullptr ? laid_over(cells, near->cells) : cells, event);
        });
    }
    map.for_each_tile([&](Cell corner, const OccupancyTile& tile) { look_at(corner, tile.cells, event); });
    return event;
}

/// The map forgets no cell: what it shows as unseen is with the far tiles.
void ChangedTiles::look_at(Cell corner, const TileCells& cells, TilesEvent& event) {
    const auto [found, is_new] = seen_.try_emplace(TileGeometry::slot(corner));
    TileCells& seen = found->second;
    if (is_new) {
        seen.fill(kUnseen);
    }
    const TileCells now = laid_over(seen, cells);
    if (is_new || now != seen) {
        seen = now;
        event.tiles.push_back(image_of(corner, seen));
    }
}

}  // namespace crspf::view
