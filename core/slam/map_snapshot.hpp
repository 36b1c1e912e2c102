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

/// Copies a map into memory of the caller, in slices, so that the thread that draws the map may do it between scans:
///
///     if (copier.begin(map, memory)) { while (!copier.step(map, tiles)) { ...other work...; } use(copier.view(...)); }
///
/// A cell is as it was when its tile was copied; tiles that the map gains meanwhile outside the rectangle are left out.
/// Real-time guarantee: no heap, no throw, no lock. One owner.
class MapCopier {
 public:
    /// Measures the map: one pass over the directory, whatever is in it. False: `memory` holds less than bytes_needed()
    /// cells, or nothing has been drawn (then bytes_needed() is 0).
    [[nodiscard]] bool begin(const OccupancyMap& map, std::span<Evidence> memory);
    /// Copies the next `tiles` places of the rectangle, 4 KiB each. True when all have been copied.
    bool step(const OccupancyMap& map, std::size_t tiles);

    /// Of the map that begin() last measured.
    [[nodiscard]] std::size_t bytes_needed() const { return bytes_needed_; }
    /// The copy, once step() has returned true. @param resolution_m that the map is drawn with
    [[nodiscard]] MapView view(double resolution_m) const;

 private:
    std::span<Evidence> memory_;
    std::size_t bytes_needed_ = 0;
    Cell corner_;
    std::int32_t columns_ = 0;  ///< [tiles]
    std::int32_t rows_ = 0;     ///< [tiles]
    std::size_t next_ = 0;      ///< [tiles] copied
};

}  // namespace crspf
