// The map as the outside world knows it, from and to the one that the SLAM works on.
#pragma once

#include <functional>
#include <span>
#include <string>
#include <vector>

#include "core/slam/map_view.hpp"
#include "core/slam/occupancy.hpp"
#include "platform/files/grid_map.hpp"

namespace crspf {

/// Paints the known cells of `map` onto a plane of cells of `resolution_m`, whatever the size and turn of its own: each
/// of ours takes the one it lies in. Throws InputError, which begins with `name`, where the map reaches beyond the
/// plane.
void paint_map(const GridMap& map, const std::string& name, double resolution_m,
               const std::function<void(Cell, Evidence)>& set_cell);

/// Throws InputError where cells that were painted found no room.
void check_all_painted(const OccupancyMap& map, const std::string& name);

using TileVisitor = std::function<void(Cell corner, const OccupancyTile&)>;
using TileVisits = std::function<void(const TileVisitor&)>;

/// Cut to what has been seen. Occupied: evidence of half or more.
/// @param for_each_tile calls its argument with each tile; it is called twice
[[nodiscard]] GridMap export_map(const TileVisits& for_each_tile, double resolution_m);
[[nodiscard]] GridMap export_map(const OccupancyMap& map, double resolution_m);

/// Cell by cell what paint_map() would paint, in the order of the map's own cells.
[[nodiscard]] std::vector<Evidence> evidence_of(const GridMap& map);
/// @param cells evidence_of(map), which must outlive the view
[[nodiscard]] MapView view_of(const GridMap& map, std::span<const Evidence> cells);

}  // namespace crspf
