// An occupancy grid as the outside world knows it: trinary cells, map_server's PGM + YAML on disk.
#pragma once

#include <cstdint>
#include <filesystem>
#include <vector>

#include "core/base/pose.hpp"

namespace crspf {

enum class GridCell : std::uint8_t { kUnknown, kFree, kOccupied };

/// A rectangular trinary map. Cell (column, row) covers the square whose lower-left corner is
/// P_map_origin * (column * resolution_m, row * resolution_m); row 0 is the lowest y (REP-103, nav_msgs/OccupancyGrid).
struct GridMap {
    int width = 0;                ///< [cells]
    int height = 0;               ///< [cells]
    double resolution_m = 0.0;    ///< [m] side of a cell
    Pose2 P_map_origin;           ///< lower-left corner of cell (0, 0) in the map frame
    std::vector<GridCell> cells;  ///< row-major, width * height

    [[nodiscard]] GridCell at(int column, int row) const {
        return cells[static_cast<std::size_t>(row) * static_cast<std::size_t>(width) +
                     static_cast<std::size_t>(column)];
    }
    [[nodiscard]] bool contains(int column, int row) const {
        return column >= 0 && row >= 0 && column < width && row < height;
    }
};

/// Reads a map_server map. `yaml` names the YAML file; its `image` is taken relative to it. PGM P5 and P2, maxval up
/// to 255. Thresholds, `negate` and `mode: trinary|scale` are honoured as map_server does.
/// Throws InputError naming file, line and remedy.
[[nodiscard]] GridMap read_grid_map(const std::filesystem::path& yaml);

/// Writes `stem`.pgm and `stem`.yaml (trinary, 254 free / 205 unknown / 0 occupied, free_thresh 0.196). Each file
/// appears whole or not at all. Throws InputError (disk full, unwritable directory ...).
void write_grid_map(const GridMap& map, const std::filesystem::path& stem);

}  // namespace crspf
