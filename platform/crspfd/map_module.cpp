#include "platform/crspfd/map_module.hpp"

namespace crspf {

bool MapModule::turn() {
    const bool drawn = draw_one();
    const bool copied = copy_some();
    return drawn || copied;
}

bool MapModule::draw_one() {
    const Draw* const draw = exchange_.draws.front();
    if (draw == nullptr) {
        return false;
    }
    // Room for what changes comes first: the filter's image must not miss any of it. The filter empties this ring
    // before each scan; until then the scan waits.
    ChangeList* const changes = exchange_.changes.full() ? nullptr : exchange_.changes.claim();
    if (changes == nullptr) {
        return false;
    }
    changes->clear();
    update_.draw(draw->points, draw->P_map_base, draw->key_frame, *changes);
    exchange_.draws.pop();
    exchange_.changes.commit();
    show();
    return true;
}

void MapModule::show() {
    exchange_.map.publish({.counters = update_.counters(), .tiles = map().tiles(), .refused = map().refused()});
}

bool MapModule::copy_some() {
    if (!copying_) {
        // Acquire, with the release of whoever wants a copy: none of the tiles is of before.
        if (exchange_.copies_wanted.load(std::memory_order_acquire) == copies_begun_) {
            return false;
        }
        copies_begun_ = exchange_.copies_wanted.load(std::memory_order_acquire);
        copying_ = true;
        next_tile_ = 0;
    }
    for (int i = 0; i < kTilesPerTurn && copying_; ++i) {
        TileCopy* const copy = exchange_.tiles.full() ? nullptr : exchange_.tiles.claim();
        if (copy == nullptr) {
            return false;
        }
        copy->copy = copies_begun_;
        copy->empty = map().tiles() == 0;
        if (!copy->empty) {
            copy->corner = map().corner(next_tile_);
            copy->tile = map().tile(next_tile_);
            ++next_tile_;
        }
        copy->last = next_tile_ >= map().tiles();
        copying_ = !copy->last;
        exchange_.tiles.commit();
    }
    return copying_;
}

}  // namespace crspf
