#include "core/slam/map_snapshot.hpp"

#include <algorithm>

namespace crspf {

bool MapCopier::begin(const OccupancyMap& map, std::span<Evidence> memory) {
    constexpr std::int32_t kSide = TileGeometry::kSide;
    constexpr std::int32_t kHalf = TileGeometry::kHalf;
    Cell low{.x = kHalf, .y = kHalf};
    Cell high{.x = -kHalf, .y = -kHalf};
    map.for_each_tile([&](Cell tile, const OccupancyTile&) {
        low = {.x = std::min(low.x, tile.x), .y = std::min(low.y, tile.y)};
        high = {.x = std::max(high.x, tile.x + kSide), .y = std::max(high.y, tile.y + kSide)};
    });
    const bool empty = high.x < low.x;
    corner_ = empty ? Cell{} : low;
    columns_ = empty ? 0 : (high.x - low.x) / kSide;
    rows_ = empty ? 0 : (high.y - low.y) / kSide;
    bytes_needed_ = static_cast<std::size_t>(columns_) * static_cast<std::size_t>(rows_) * TileGeometry::kCells;
    next_ = 0;
    const bool fits = !empty && bytes_needed_ <= memory.size();
    memory_ = fits ? memory.first(bytes_needed_) : std::span<Evidence>{};
    return fits;
}

bool MapCopier::step(const OccupancyMap& map, std::size_t tiles) {
    constexpr auto kSide = static_cast<std::size_t>(TileGeometry::kSide);
    const auto columns = static_cast<std::size_t>(columns_);
    const std::size_t all = memory_.size() / TileGeometry::kCells;
    const std::size_t end = next_ + std::min(tiles, all - next_);
    for (; next_ < end; ++next_) {
        const std::size_t column = next_ % columns;
        const std::size_t row = next_ / columns;
        const Cell corner{.x = corner_.x + static_cast<std::int32_t>(column * kSide),
                          .y = corner_.y + static_cast<std::int32_t>(row * kSide)};
        const OccupancyTile& tile = map.pool()[map.directory()[TileGeometry::slot(corner)]];
        const Evidence* from = tile.cells.data();
        Evidence* to = memory_.data() + (row * kSide * columns + column) * kSide;
        for (std::size_t y = 0; y < kSide; ++y, from += kSide, to += columns * kSide) {
            std::copy_n(from, kSide, to);
        }
    }
    return next_ == all;
}

MapView MapCopier::view(double resolution_m) const {
    return {.cells = memory_,
            .width = columns_ * TileGeometry::kSide,
            .height = rows_ * TileGeometry::kSide,
            .resolution_m = resolution_m,
            .P_map_corner = {.x_m = corner_.x * resolution_m, .y_m = corner_.y * resolution_m, .theta_rad = 0.0}};
}

}  // namespace crspf
