// What the modules show to those who watch, onto the board.
#pragma once

#include <cstdint>

#include "core/base/time.hpp"
#include "core/slam/slam_params.hpp"
#include "platform/crspfd/exchange.hpp"
#include "platform/crspfd/watch_board.hpp"
#include "platform/service/tile_archive.hpp"

namespace crspf {

/// The control thread's. Asks for scans and for pictures of the map while somebody watches, takes what has come, and
/// waits for nobody: a picture comes piecewise. What is far comes from its keeper, after the first picture and whenever
/// a tile has gone there that nobody had seen.
class WatchFeed {
 public:
    static constexpr Duration kPicturePeriod{500'000'000};  ///< from the order of one to that of the next, at least

    WatchFeed(Exchange& exchange, TileArchive& far_tiles, const SlamParams& params)
        : exchange_(exchange),
          far_tiles_(far_tiles),
          resolution_m_(params.map.resolution_m),
          thresholds_(params.analyser) {}

    /// @return whether the map's thread has something to do
    bool turn(Stamp now, Duration utc_minus_stamp, WatchBoard& board);

 private:
    void order_picture(Stamp now, bool watched, bool whole);
    void take_picture(WatchBoard& board);
    void take_far_tiles(WatchBoard& board);

    Exchange& exchange_;
    TileArchive& far_tiles_;
    double resolution_m_;
    AnalyserParams thresholds_;
    bool watching_ = false;
    PictureOrder order_;
    Stamp ordered_;
    bool picturing_ = false;  ///< the order has not been carried out to its end
    bool look_far_ = false;   ///< nor have all far tiles been looked through
    std::uint32_t far_number_ = 0;
};

}  // namespace crspf
