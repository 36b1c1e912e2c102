// The map update's thread (paper Section 5). The map is its own; the filter is told what changed.
#pragma once

#include <cstddef>
#include <cstdint>

#include "core/slam/map_update.hpp"
#include "platform/crspfd/exchange.hpp"

namespace crspf {

/// One thread's. turn(): no heap, no lock, no throw; one scan, and kTilesPerTurn tiles of a copy.
class MapModule {
 public:
    static constexpr int kTilesPerTurn = 4;

    MapModule(const MapParams& params, double range_noise_m, Exchange& exchange)
        : update_(params, range_noise_m), exchange_(exchange) {}

    /// Before the threads run: a cell of a map that is loaded. What changed goes to `changes`.
    void set(Cell cell, Evidence evidence, ChangeList& changes) { update_.set(cell, evidence, changes); }
    /// The map as it is now, for the status. turn() does it after each scan.
    void show();
    [[nodiscard]] const OccupancyMap& map() const { return update_.map(); }

    /// True where there is more to do at once.
    bool turn();

 private:
    bool draw_one();
    bool copy_some();

    MapUpdate update_;
    Exchange& exchange_;
    std::uint32_t copies_begun_ = 0;
    bool copying_ = false;
    std::size_t next_tile_ = 0;
};

}  // namespace crspf
