// A copy of the map as one rectangle of cells: what a thread that must not touch the map works on.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "core/base/pose.hpp"
#include "core/slam/occupancy.hpp"

namespace crspf {

/// A rectangle of map cells, row by row from the lowest y: cell (column, row) covers the square whose lower-left corner
/// is P_map_corner * (column, row) * resolution_m. Points to memory that it does not own.
struct MapView {
    std::span<const Evidence> cells;  ///< width * height
    std::int32_t width = 0;           ///< [cells]
    std::int32_t height = 0;          ///< [cells]
    double resolution_m = 0.0;        ///< [m] side of a cell
    Pose2 P_map_corner;               ///< lower-left corner of cell (0, 0)

    /// The evidence in a cell; unseen outside.
    [[nodiscard]] Evidence at(std::int32_t x, std::int32_t y) const {
        const bool inside = x >= 0 && y >= 0 && x < width && y < height;
        return inside
                   ? cells[static_cast<std::size_t>(y) * static_cast<std::size_t>(width) + static_cast<std::size_t>(x)]
                   : kUnseen;
    }
};

}  // namespace crspf
