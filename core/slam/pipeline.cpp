#include "core/slam/pipeline.hpp"

namespace crspf {

ScanResult Pipeline::on_scan(const Scan& scan, const ScanTiming& timing) {
    follow(timing);
    const ScanResult result = localizer_.on_scan(scan);
    update_map(result, timing);
    return result;
}

std::optional<ScanResult> Pipeline::on_cloud(const Cloud& cloud, const ScanTiming& timing) {
    follow(timing);
    const std::optional<ScanResult> result = localizer_.on_cloud(cloud);
    if (result) {
        update_map(*result, timing);
    }
    return result;
}

void Pipeline::follow(const ScanTiming& timing) {
    for (const ChangeList* changes = nullptr; followed_ < timing.changes && (changes = changes_.front()) != nullptr;
         ++followed_) {
        localizer_.follow(*changes);
        changes_.pop();
    }
}

void Pipeline::update_map(const ScanResult& result, const ScanTiming& timing) {
    ChangeList* const changes = result.matched && timing.update ? changes_.claim() : nullptr;
    if (changes == nullptr) {
        return;
    }
    const ScanTiming::Tiles tiles = timing.tiles.value_or(ScanTiming::Tiles{
        .tidy = has_keeper_ && room_to_tidy(tile_rings_, 0), .tiles = next_tiles(tile_rings_, tiles_)});
    tiles_ = tiles.tiles;
    const std::uint64_t refused_before = changes->refused();
    changes->clear();
    map_.update({.P_map_base = result.P_map_base,
                 .draw = result.to_draw,
                 .key_frame = result.result,
                 .tidy = tiles.tidy,
                 .sight_m = sight_of(localizer_.points()),
                 .tiles = tiles.tiles},
                localizer_.points(), *changes);
    changes_refused_ += changes->refused() - refused_before;
    changes_.commit();
}

void Pipeline::load(const TileRecord& tile) {
    if (ChangeList* const changes = changes_.claim()) {  // before the first scan it is empty
        changes->clear();
        map_.load(tile, *changes);
        localizer_.follow(*changes);
    }
}

}  // namespace crspf
