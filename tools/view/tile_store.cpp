#include "tools/view/tile_store.hpp"

#include <algorithm>
#include <limits>
#include <utility>

#include "platform/files/base64.hpp"

namespace crspf::view {
namespace {

constexpr std::int32_t kSide = TileGeometry::kSide;

/// The more certain to be taken; anything rather than unseen.
std::uint8_t more_taken(std::uint8_t a, std::uint8_t b) {
    if (a == TileImage::kUnseen || b == TileImage::kUnseen) {
        return std::min(a, b);
    }
    return std::max(a, b);
}

}  // namespace

void TileStore::take(const TilesEvent& event) {
    if (event.fresh || version() == 0) {
        map_.begin();
    }
    resolution_m_ = event.resolution_m;
    for (const TileImage& image : event.tiles) {
        map_.take(image);
    }
}

Json TileStore::changes_since(std::uint64_t& cursor, std::int64_t stamp_ns) const {
    const bool fresh = map_.fresh_for(cursor);
    Json tiles = Json::array();
    while (tiles.size() < kTilesAtOnce) {
        const TileImage* const image = map_.next(cursor);
        if (image == nullptr) {
            break;
        }
        tiles.push_back({{"x", image->corner.x}, {"y", image->corner.y}, {"data", to_base64(image->cells)}});
    }
    return {{"timestamp", time_of(stamp_ns)},
            {"fresh", fresh},
            {"resolution_m", resolution_m_},
            {"side_cells", kSide},
            {"tiles", std::move(tiles)}};
}

GridPicture TileStore::picture() const {
    Cell low{.x = std::numeric_limits<std::int32_t>::max(), .y = std::numeric_limits<std::int32_t>::max()};
    Cell high{.x = std::numeric_limits<std::int32_t>::min(), .y = std::numeric_limits<std::int32_t>::min()};
    map_.for_each_tile([&](const TileImage& image) {
        const Cell corner = image.corner;
        low = {.x = std::min(low.x, corner.x), .y = std::min(low.y, corner.y)};
        high = {.x = std::max(high.x, corner.x + kSide), .y = std::max(high.y, corner.y + kSide)};
    });
    // Tiles are a power of two wide: coarser cells never lie in two of them.
    std::int32_t coarse = 1;
    const auto cells = [&](std::int32_t coarseness) {
        return static_cast<std::uint64_t>((high.x - low.x) / coarseness) *
               static_cast<std::uint64_t>((high.y - low.y) / coarseness);
    };
    while (cells(coarse) > kPictureCellsMax && coarse < kSide) {
        coarse *= 2;
    }
    GridPicture picture;
    picture.P_map_corner = {.x_m = low.x * resolution_m_, .y_m = low.y * resolution_m_, .theta_rad = 0.0};
    picture.cell_m = coarse * resolution_m_;
    picture.columns = static_cast<std::uint32_t>((high.x - low.x) / coarse);
    picture.cells.assign(static_cast<std::size_t>((high.y - low.y) / coarse) * picture.columns, TileImage::kUnseen);
    map_.for_each_tile([&](const TileImage& image) {
        const Cell corner = image.corner;
        for (std::int32_t y = 0; y < kSide; ++y) {
            const auto row = static_cast<std::size_t>((corner.y + y - low.y) / coarse) * picture.columns;
            for (std::int32_t x = 0; x < kSide; ++x) {
                std::uint8_t& cell = picture.cells[row + static_cast<std::size_t>((corner.x + x - low.x) / coarse)];
                cell = more_taken(cell, image.cells[TileGeometry::offset({.x = x, .y = y})]);
            }
        }
    });
    return picture;
}

}  // namespace crspf::view
