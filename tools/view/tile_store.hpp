// The map as messages: what has changed since a reader asked last, and the whole of it as one picture.
#pragma once

#include <cstddef>
#include <cstdint>

#include "tools/view/messages.hpp"
#include "tools/view/run_events.hpp"

namespace crspf::view {

class TileStore {
 public:
    /// Of one message: 90 kB of text.
    static constexpr std::size_t kTilesAtOnce = 16;
    /// Of a picture: a larger map comes in coarser cells.
    static constexpr std::size_t kPictureCellsMax = std::size_t{1} << 22U;

    void take(const TilesEvent& event);

    /// The number of the last change. 0: there was no map yet.
    [[nodiscard]] std::uint64_t version() const { return map_.version(); }
    [[nodiscard]] bool empty() const { return map_.empty(); }
    [[nodiscard]] const ShownMap& map() const { return map_; }
    [[nodiscard]] double resolution_m() const { return resolution_m_; }

    /// crspf.MapTiles: what has changed since `cursor`, which moves on, the oldest change first, at most kTilesAtOnce.
    /// Only where version() is beyond it.
    [[nodiscard]] Json changes_since(std::uint64_t& cursor, std::int64_t stamp_ns) const;
    /// The whole map; a cell that is coarser shows the most taken of its own. Not while it is empty.
    [[nodiscard]] GridPicture picture() const;

 private:
    ShownMap map_;
    double resolution_m_ = 0.0;
};

}  // namespace crspf::view
