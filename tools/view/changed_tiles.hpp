// Which tiles of a map have another picture than when they were looked at last.
#pragma once

#include <cstddef>
#include <unordered_map>

#include "core/slam/occupancy.hpp"
#include "platform/service/tile_archive.hpp"
#include "tools/view/run_events.hpp"

namespace crspf::view {

/// Remembers each tile's cells: 4 KiB a tile that has been seen.
class ChangedTiles {
 public:
    explicit ChangedTiles(double resolution_m) : resolution_m_(resolution_m) {}

    /// The tiles that have changed since the last look. The first look is `fresh`.
    /// @param far what went there since the last look is looked at, too; nullptr: that waits for another one
    [[nodiscard]] TilesEvent look(const OccupancyMap& map, TileArchive* far);

 private:
    void look_at(Cell corner, const TileCells& cells, TilesEvent& event);

    double resolution_m_;
    bool looked_ = false;
    std::unordered_map<std::size_t, TileCells> seen_;  ///< by TileGeometry::slot()
};

}  // namespace crspf::view
