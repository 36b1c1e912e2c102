#include "platform/crspfd/map_module.hpp"

namespace crspf {

bool MapModule::turn() {
    const bool updated = update_one();
    const bool copied = copy_some();
    return updated || copied;
}

bool MapModule::update_one() {
    const MapOrder* const order = exchange_.orders.front();
    if (order == nullptr) {
        return false;
    }
    // Room for what changes comes first: the filter's image must not miss any of it. The filter empties this ring
    // before each scan; until then the scan waits.
    ChangeList* const changes = exchange_.changes.full() ? nullptr : exchange_.changes.claim();
    if (changes == nullptr) {
        return false;
    }
    changes->clear();
    map_.update(order->task, order->points, *changes);
    exchange_.orders.pop();
    exchange_.changes.commit();
    show();
    return true;
}

void MapModule::show() {
    exchange_.map.publish({.counters = map_.counters(), .tiles = map().tiles(), .refused = map().refused()});
}

bool MapModule::copy_some() {
    if (!copying_) {
        // Acquire, with the release of whoever wants a copy: none of the tiles is of before.
        if (exchange_.copies_wanted.load(std::memory_order_acquire) == copies_begun_) {
            return false;
        }
        copies_begun_ = exchange_.copies_wanted.load(std::memory_order_acquire);
        copying_ = true;
        next_place_ = 0;
    }
    for (int i = 0; i < kTilesPerTurn && copying_; ++i) {
        TileCopy* const copy = exchange_.tiles.full() ? nullptr : exchange_.tiles.claim();
        if (copy == nullptr) {
            return false;
        }
        copy->copy = copies_begun_;
        // One that goes away meanwhile is with the keeper.
        next_place_ = map().next_place(next_place_);
        copy->empty = next_place_ == map().places();
        if (!copy->empty) {
            copy->corner = map().corner(next_place_);
            copy->tile = map().tile(next_place_);
            next_place_ = map().next_place(next_place_ + 1);
        }
        copy->last = next_place_ == map().places();
        copying_ = !copy->last;
        exchange_.tiles.commit();
    }
    return copying_;
}

}  // namespace crspf
