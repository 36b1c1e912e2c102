// The map as it was shown last: tiles, each with the number of its last change.
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <unordered_map>

#include "tools/view/messages.hpp"
#include "tools/view/run_events.hpp"

namespace crspf::view {

/// 4 KiB a tile that has been seen.
class TileStore {
 public:
    /// Of one message: 90 kB of text.
    static constexpr std::size_t kTilesAtOnce = 16;
    /// Of a picture: a larger map comes in coarser cells.
    static constexpr std::size_t kPictureCellsMax = std::size_t{1} << 22U;

    void take(const TilesEvent& event);

    /// The number of the last change. 0: there was no map yet.
    [[nodiscard]] std::uint64_t version() const { return version_; }
    [[nodiscard]] bool empty() const { return tiles_.empty(); }

    /// crspf.MapTiles: what has changed since `cursor`, which moves on, the oldest change first, at most kTilesAtOnce.
    /// Only where version() is beyond it.
    [[nodiscard]] Json changes_since(std::uint64_t& cursor, std::int64_t stamp_ns) const;
    /// The whole map; a cell that is coarser shows the most taken of its own. Not while it is empty.
    [[nodiscard]] GridPicture picture() const;

 private:
    struct Kept {
        std::uint64_t version = 0;
        TileImage image;
    };

    std::unordered_map<std::size_t, Kept> tiles_;     ///< by TileGeometry::slot()
    std::map<std::uint64_t, std::size_t> by_change_;  ///< version -> slot
    std::uint64_t version_ = 0;
    std::uint64_t fresh_version_ = 0;  ///< all tiles before were forgotten then
    double resolution_m_ = 0.0;
};

}  // namespace crspf::view
