// The map as the outside world knows it, from and to the one that the SLAM works on.
#pragma once

#include <functional>
#include <span>
#include <string>
#include <vector>

#include "core/slam/map_view.hpp"
#include "core/slam/occupancy.hpp"
#include "core/slam/roaming_map.hpp"
#include "platform/files/grid_map.hpp"
#include "platform/service/tile_archive.hpp"

namespace crspf {

/// The known cells of `map` as tiles of cells of `resolution_m`, whatever the size and turn of its own: each of ours
/// takes the one it lies in. The nearest to `robot` first. Throws InputError, which begins with `name`, where the map
/// reaches beyond the plane of cells.
[[nodiscard]] std::vector<TileRecord> tiles_of(const GridMap& map, const std::string& name, double resolution_m,
                                               const Pose2& robot);

using TileVisitor = std::function<void(Cell corner, const TileCells& cells)>;
using TileVisits = std::function<void(const TileVisitor&)>;

/// Cut to what has been seen. Occupied: evidence of half or more. In coarser cells where it has more than kMapCellsMax.
/// @param for_each_tile calls its argument with each tile; it is called twice
[[nodiscard]] GridMap export_map(const TileVisits& for_each_tile, double resolution_m);
/// @param far tiles that the map does not have any longer
[[nodiscard]] GridMap export_map(const OccupancyMap& map, double resolution_m, TileArchive* far = nullptr);

/// Cell by cell what tiles_of() would hold, in the order of the map's own cells.
[[nodiscard]] std::vector<Evidence> evidence_of(const GridMap& map);
/// @param cells evidence_of(map), which must outlive the view
[[nodiscard]] MapView view_of(const GridMap& map, std::span<const Evidence> cells);

}  // namespace crspf
