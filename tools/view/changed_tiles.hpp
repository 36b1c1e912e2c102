// Which tiles of a map have another picture than when they were looked at last.
#pragma once

#include <cstdint>

#include "core/slam/occupancy.hpp"
#include "platform/service/shown_map.hpp"
#include "platform/service/tile_archive.hpp"
#include "tools/view/run_events.hpp"

namespace crspf::view {

/// 4 KiB a tile that has been seen.
class ChangedTiles {
 public:
    explicit ChangedTiles(double resolution_m) : resolution_m_(resolution_m) { shown_.begin(); }

    /// The tiles that have changed since the last look. The first look is `fresh`.
    /// @param far what went there since the last look is looked at, too; nullptr: that waits for another one
    [[nodiscard]] TilesEvent look(const OccupancyMap& map, TileArchive* far);

 private:
    double resolution_m_;
    ShownMap shown_;
    std::uint64_t told_ = 0;
};

}  // namespace crspf::view
