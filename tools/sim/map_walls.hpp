// Between exact walls and occupancy grids, both ways.
#pragma once

#include <vector>

#include "platform/files/grid_map.hpp"
#include "tools/sim/world.hpp"

namespace crspf::sim {

/// The borders of a map's free cells. What is not known to be free is solid, and so is the map's edge: maps made by
/// SLAM have walls with holes of unknown cells, and nobody should see or drive through them.
[[nodiscard]] std::vector<Segment> walls_of(const GridMap& map);

/// Centre of the free cell that is farthest from all others. The map must have a free cell.
[[nodiscard]] Point most_open_place(const GridMap& map);

/// Walls seen from inside: occupied where a wall runs beside a cell that can be reached from `inside`, free what can be
/// reached, unknown elsewhere.
[[nodiscard]] GridMap rasterize(const World& world, Point inside, double resolution_m);

}  // namespace crspf::sim
