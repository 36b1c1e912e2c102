#include "platform/crspfd/map_module.hpp"

#include <utility>

namespace crspf {

bool MapModule::turn() {
    const bool updated = update_one();
    const bool copied = copy_some();
    const bool pictured = picture_some();
    return updated || copied || pictured;
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
    if (order_.watched) {
        mark_changed(*changes);
    }
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

void MapModule::mark_changed(const ChangeList& changes) {
    const auto mark = [this](Cell cell) {
        if (const OccupancyMap::TileId tile = map().directory()[TileGeometry::slot(cell)]; tile != 0) {
            changed_.set(tile - 1U);  // its place
        }
    };
    bool gone = false;
    for (const TileChange& tile : changes.tiles()) {
        gone = gone || tile.gone;
        mark(tile.corner);
    }
    for (const CellChange& change : changes.view()) {
        mark(change.cell);
    }
    for (std::size_t place = 0; gone && place < map().places(); ++place) {
        if ((changed_.test(place) || to_picture_.test(place)) && map().next_place(place) != place) {
            changed_.reset(place);
            to_picture_.reset(place);
            missed_ = true;
        }
    }
}

void MapModule::begin_picture(PictureOrder order) {
    order_ = order;
    picturing_ = order.watched;
    next_pictured_ = 0;
    if (!order.watched || order.whole) {
        changed_.reset();
        to_picture_.reset();
        missed_ = false;
    }
    for (std::size_t place = map().next_place(0); order.whole && place < map().places();
         place = map().next_place(place + 1)) {
        changed_.set(place);
    }
    to_picture_ |= changed_;
    changed_.reset();
}

bool MapModule::picture_some() {
    // Acquire, with the release of whoever ordered it: none of the tiles is of before.
    if (const PictureOrder order = exchange_.picture_order.load(std::memory_order_acquire);
        order.number != order_.number) {
        begin_picture(order);
    }
    for (int i = 0; i < kTilesPerTurn && picturing_; ++i) {
        while (next_pictured_ < map().places() && !to_picture_.test(next_pictured_)) {
            ++next_pictured_;
        }
        const bool end = next_pictured_ == map().places();
        if (!post(end)) {
            return false;
        }
        picturing_ = !end;
    }
    return picturing_;
}

bool MapModule::post(bool end) {
    PictureTile* const tile = exchange_.picture.full() ? nullptr : exchange_.picture.claim();
    if (tile == nullptr) {
        return false;
    }
    tile->picture = order_.number;
    tile->end = end;
    tile->missed = end && std::exchange(missed_, false);
    if (!end) {
        tile->corner = map().corner(next_pictured_);
        tile->cells = map().tile(next_pictured_).cells;
        to_picture_.reset(next_pictured_);
    }
    exchange_.picture.commit();
    return true;
}

}  // namespace crspf
