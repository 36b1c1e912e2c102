#include "platform/crspfd/watch_feed.hpp"

#include <atomic>
#include <cstddef>
#include <utility>

namespace crspf {

namespace {

constexpr std::uint32_t kFarTilesAtOnce = 32;

}  // namespace

bool WatchFeed::turn(Stamp now, Duration utc_minus_stamp, WatchBoard& board) {
    const bool watched_before = std::exchange(watching_, board.watched());
    if (!watching_) {
        if (watched_before) {
            exchange_.scans_watched.store(false, std::memory_order_relaxed);
            order_picture(now, false, false);
        }
        return watched_before;
    }
    if (!watched_before) {
        static_cast<void>(exchange_.watched.update());  // one of an earlier time may lie there
        exchange_.scans_watched.store(true, std::memory_order_relaxed);
        board.begin_map(resolution_m_);
        order_picture(now, true, true);
    }
    if (exchange_.watched.update()) {
        board.take_scan(exchange_.watched.value(), utc_minus_stamp, thresholds_);
    }
    take_picture(board);
    take_far_tiles(board);
    if (!picturing_ && !look_far_ && now - ordered_ >= kPicturePeriod) {
        order_picture(now, true, false);
    }
    return picturing_;
}

void WatchFeed::order_picture(Stamp now, bool watched, bool whole) {
    ordered_ = now;
    order_ = {.number = static_cast<std::uint16_t>(order_.number + 1U), .watched = watched, .whole = whole};
    picturing_ = watched;
    look_far_ = false;
    // Release, with the map's acquire.
    exchange_.picture_order.store(order_, std::memory_order_release);
}

void WatchFeed::take_picture(WatchBoard& board) {
    for (std::size_t i = 0; i < decltype(exchange_.picture)::kCapacity; ++i) {
        const PictureTile* const tile = exchange_.picture.front();
        if (tile == nullptr) {
            return;
        }
        const bool ours = tile->picture == order_.number;  // not what is left of one that was given up
        if (ours && !tile->end) {
            board.take_tile(tile->corner, tile->cells);
        }
        if (ours && tile->end) {
            picturing_ = false;
            look_far_ = order_.whole || tile->missed;
            far_number_ = 0;
        }
        exchange_.picture.pop();
    }
}

void WatchFeed::take_far_tiles(WatchBoard& board) {
    if (!look_far_) {
        return;
    }
    if (far_number_ == 0) {
        far_tiles_.turn(exchange_.far_tiles);  // what was sent away meanwhile is not missed
    }
    look_far_ = far_tiles_.for_some_away(far_number_, kFarTilesAtOnce, [&board](Cell corner, const TileCells& cells) {
        board.take_tile(corner, cells);
    });
}

}  // namespace crspf
