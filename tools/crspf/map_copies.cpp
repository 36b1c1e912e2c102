#include "tools/crspf/map_copies.hpp"

#include <algorithm>
#include <stdexcept>
#include <vector>

#include "core/slam/tile_grid.hpp"

namespace crspf {

void load_copies(const OccupancyMap& map, std::int32_t copies, Pipeline& pipeline) {
    constexpr std::int32_t kInARow = 4;
    std::vector<TileRecord> tiles;
    Cell lower{.x = TileGeometry::kHalf, .y = TileGeometry::kHalf};
    Cell upper{.x = -TileGeometry::kHalf, .y = -TileGeometry::kHalf};
    map.for_each_tile([&](Cell corner, const OccupancyTile& tile) {
        lower = {.x = std::min(lower.x, corner.x), .y = std::min(lower.y, corner.y)};
        upper = {.x = std::max(upper.x, corner.x), .y = std::max(upper.y, corner.y)};
        tiles.push_back({.cell = corner, .cells = tile.cells});
    });
    const std::int32_t width = upper.x - lower.x + 2 * TileGeometry::kSide;
    const std::int32_t height = upper.y - lower.y + 2 * TileGeometry::kSide;
    const std::size_t before = pipeline.map().tiles();
    for (std::int32_t copy = 1; copy <= copies; ++copy) {
        const Cell away{.x = copy % kInARow * width, .y = copy / kInARow * height};
        for (TileRecord tile : tiles) {
            tile.cell = {.x = tile.cell.x + away.x, .y = tile.cell.y + away.y};
            pipeline.load(tile);
        }
    }
    if (pipeline.map().tiles() != before + tiles.size() * static_cast<std::size_t>(copies)) {
        throw std::length_error("capacity::kTiles is too small for so many copies of a map");
    }
}

}  // namespace crspf
