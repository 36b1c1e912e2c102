// A map to plan paths on (paper Section 7, Fig. 18): lone marks taken out, obstacles a cell wider.
#pragma once

#include "platform/files/grid_map.hpp"

namespace crspf {

/// The paper's median filter and its expansion by one cell. Its walls are thick; here one is often a single cell, which
/// a median would take out with the noise. So the median of 5 x 5 cells is that of the expanded map, and takes
/// obstacles away, but adds none: what stands alone with less than three cells goes, a wall of one cell stays, a
/// doorway stays open. What goes takes the word of the free and unknown cells round it. What is left is expanded by a
/// cell.
[[nodiscard]] GridMap planning_map(const GridMap& map);

}  // namespace crspf
