// The map update's thread (paper Section 5). The map is its own; the filter is told what changed.
#pragma once

#include <bitset>
#include <cstddef>
#include <cstdint>

#include "config/capacities.hpp"
#include "core/slam/roaming_map.hpp"
#include "platform/crspfd/exchange.hpp"

namespace crspf {

/// One thread's. turn(): no heap, no lock, no throw; one scan, and kTilesPerTurn tiles each of a copy and of a picture.
class MapModule {
 public:
    static constexpr int kTilesPerTurn = 4;

    MapModule(const SlamParams& params, Exchange& exchange) : map_(params, exchange.far_tiles), exchange_(exchange) {}

    /// Before the threads run: a part of a map that is loaded. What changed goes to `changes`.
    void load(const TileRecord& tile, ChangeList& changes) { map_.load(tile, changes); }
    /// The map as it is now, for the status. turn() does it after each scan.
    void show();
    [[nodiscard]] const OccupancyMap& map() const { return map_.map(); }

    /// True where there is more to do at once.
    bool turn();

 private:
    bool update_one();
    bool copy_some();
    void mark_changed(const ChangeList& changes);
    void begin_picture(PictureOrder order);
    bool picture_some();
    /// A tile, or where `end`, the end of the picture. False: there is no room for it yet.
    bool post(bool end);

    using Places = std::bitset<capacity::kTiles>;

    RoamingMap map_;
    Exchange& exchange_;
    std::uint32_t copies_begun_ = 0;
    bool copying_ = false;
    std::size_t next_place_ = 0;

    // For those who watch.
    PictureOrder order_;
    bool picturing_ = false;
    std::size_t next_pictured_ = 0;  ///< place
    Places changed_;                 ///< since the picture was begun
    Places to_picture_;
    bool missed_ = false;  ///< PictureTile::missed
};

}  // namespace crspf
