#include "platform/service/map_image.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <string>

#include "platform/files/input_error.hpp"
#include "platform/files/map_server_format.hpp"

namespace crspf {

std::vector<TileRecord> tiles_of(const GridMap& map, const std::string& name, double resolution_m, const Pose2& robot) {
    std::map<std::size_t, TileRecord> tiles;  // by TileGeometry::slot()
    const auto set_cell = [&tiles](Cell cell, Evidence evidence) {
        const auto [found, is_new] = tiles.try_emplace(TileGeometry::slot(cell));
        TileRecord& tile = found->second;
        if (is_new) {
            tile.cell = {.x = cell.x & ~TileGeometry::kMask, .y = cell.y & ~TileGeometry::kMask};
            tile.cells.fill(kUnseen);
        }
        tile.cells[TileGeometry::offset(cell)] = evidence;
    };
    // The map's cells are painted onto ours, whatever their size and turn: each of ours takes the one it lies in.
    const Pose2 P_origin_map = inverse(map.P_map_origin);
    const double width_m = map.width * map.resolution_m;
    const double height_m = map.height * map.resolution_m;
    double low_x = 1e300;
    double low_y = 1e300;
    double high_x = -1e300;
    double high_y = -1e300;
    for (const auto& [x, y] :
         std::array<std::array<double, 2>, 4>{{{0.0, 0.0}, {width_m, 0.0}, {0.0, height_m}, {width_m, height_m}}}) {
        const Pose2 corner = map.P_map_origin * Pose2{.x_m = x, .y_m = y, .theta_rad = 0.0};
        low_x = std::min(low_x, corner.x_m);
        low_y = std::min(low_y, corner.y_m);
        high_x = std::max(high_x, corner.x_m);
        high_y = std::max(high_y, corner.y_m);
    }
    constexpr double kExtent = TileGeometry::kHalf;
    if (low_x < -kExtent * resolution_m || low_y < -kExtent * resolution_m || high_x > kExtent * resolution_m ||
        high_y > kExtent * resolution_m) {
        throw InputError(name + ": the map reaches " + std::to_string(kExtent * resolution_m) +
                         " m or more from the origin; raise [map] resolution_m or capacity::kDirectoryTiles");
    }
    const auto cell = [resolution_m](double v) { return static_cast<std::int32_t>(std::floor(v / resolution_m)); };
    for (std::int32_t y = cell(low_y); y <= cell(high_y); ++y) {
        for (std::int32_t x = cell(low_x); x <= cell(high_x); ++x) {
            const Pose2 middle{.x_m = (x + 0.5) * resolution_m, .y_m = (y + 0.5) * resolution_m, .theta_rad = 0.0};
            const Pose2 in_map = P_origin_map * middle;
            const int column = static_cast<int>(std::floor(in_map.x_m / map.resolution_m));
            const int row = static_cast<int>(std::floor(in_map.y_m / map.resolution_m));
            if (!map.contains(column, row)) {
                continue;
            }
            switch (map.at(column, row)) {
                case GridCell::kFree: set_cell({.x = x, .y = y}, kFreeCell); break;
                case GridCell::kOccupied: set_cell({.x = x, .y = y}, kOccupiedCell); break;
                case GridCell::kUnknown: break;
            }
        }
    }
    std::vector<TileRecord> sorted;
    sorted.reserve(tiles.size());
    for (const auto& [slot, tile] : tiles) {
        sorted.push_back(tile);
    }
    const auto distance = [&](const TileRecord& tile) {
        constexpr double kMiddle = 0.5 * TileGeometry::kSide;
        return std::hypot((tile.cell.x + kMiddle) * resolution_m - robot.x_m,
                          (tile.cell.y + kMiddle) * resolution_m - robot.y_m);
    };
    std::stable_sort(sorted.begin(), sorted.end(),
                     [&distance](const TileRecord& a, const TileRecord& b) { return distance(a) < distance(b); });
    return sorted;
}

GridMap export_map(const TileVisits& for_each_tile, double resolution_m) {
    constexpr std::int32_t kHalf = TileGeometry::kHalf;
    std::int32_t low_x = kHalf;
    std::int32_t low_y = kHalf;
    std::int32_t high_x = -kHalf;
    std::int32_t high_y = -kHalf;
    for_each_tile([&](Cell corner, const TileCells&) {
        low_x = std::min(low_x, corner.x);
        low_y = std::min(low_y, corner.y);
        high_x = std::max(high_x, corner.x + TileGeometry::kSide);
        high_y = std::max(high_y, corner.y + TileGeometry::kSide);
    });
    GridMap out;
    if (high_x < low_x) {  // nothing seen: one unknown cell, so that the file is still a map
        high_x = low_x = high_y = low_y = 0;
        ++high_x;
        ++high_y;
    }
    // A map that would be too large for a file is exported in coarser cells; a wall wins.
    std::int32_t coarse = 1;
    const auto side = [&coarse](std::int32_t cells) { return (cells + coarse - 1) / coarse; };
    while (static_cast<std::size_t>(side(high_x - low_x)) * static_cast<std::size_t>(side(high_y - low_y)) >
           kMapCellsMax) {
        coarse *= 2;
    }
    out.width = side(high_x - low_x);
    out.height = side(high_y - low_y);
    out.resolution_m = coarse * resolution_m;
    out.P_map_origin = {.x_m = low_x * resolution_m, .y_m = low_y * resolution_m, .theta_rad = 0.0};
    out.cells.assign(static_cast<std::size_t>(out.width) * static_cast<std::size_t>(out.height), GridCell::kUnknown);
    for_each_tile([&](Cell corner, const TileCells& cells) {
        for (std::int32_t y = 0; y < TileGeometry::kSide; ++y) {
            const std::size_t row =
                static_cast<std::size_t>((corner.y + y - low_y) / coarse) * static_cast<std::size_t>(out.width);
            for (std::int32_t x = 0; x < TileGeometry::kSide; ++x) {
                const Evidence e = cells[TileGeometry::offset({.x = x, .y = y})];
                GridCell& cell = out.cells[row + static_cast<std::size_t>((corner.x + x - low_x) / coarse)];
                if (e >= kOccupiedFrom) {
                    cell = GridCell::kOccupied;
                } else if (e != kUnseen && (coarse == 1 || cell == GridCell::kUnknown)) {
                    cell = GridCell::kFree;
                }
            }
        }
    });
    return out;
}

std::vector<Evidence> evidence_of(const GridMap& map) {
    std::vector<Evidence> cells(map.cells.size(), kUnseen);
    std::transform(map.cells.begin(), map.cells.end(), cells.begin(), [](GridCell cell) {
        switch (cell) {
            case GridCell::kFree: return kFreeCell;
            case GridCell::kOccupied: return kOccupiedCell;
            case GridCell::kUnknown: break;
        }
        return kUnseen;
    });
    return cells;
}

MapView view_of(const GridMap& map, std::span<const Evidence> cells) {
    return {.cells = cells,
            .width = map.width,
            .height = map.height,
            .resolution_m = map.resolution_m,
            .P_map_corner = map.P_map_origin};
}

GridMap export_map(const OccupancyMap& map, double resolution_m, TileArchive* far) {
    return export_map(
        [&map, far](const TileVisitor& visit) {
            if (far != nullptr) {
                far->for_each_tile(visit);
            }
            map.for_each_tile([&visit](Cell corner, const OccupancyTile& tile) { visit(corner, tile.cells); });
        },
        resolution_m);
}

}  // namespace crspf
