#include "platform/service/shown_map.hpp"

#include <algorithm>

namespace crspf {

TileImage image_of(Cell corner, const TileCells& cells) {
    TileImage image{.corner = corner};
    std::transform(cells.begin(), cells.end(), image.cells.begin(), percent_of);
    return image;
}

void ShownMap::begin() {
    by_change_.clear();
    tiles_.clear();
    begun_ = ++version_;
}

void ShownMap::take(const TileImage& image) {
    if (!TileGeometry::inside(image.corner)) {
        return;
    }
    const auto [found, is_new] = tiles_.try_emplace(TileGeometry::slot(image.corner));
    Tile& tile = found->second;
    bool changed = is_new;
    if (is_new) {
        tile.image = image;
    }
    for (std::size_t i = 0; i < image.cells.size(); ++i) {
        const std::uint8_t percent = image.cells[i];
        if (percent != TileImage::kUnseen && percent != tile.image.cells[i]) {
            tile.image.cells[i] = percent;
            changed = true;
        }
    }
    if (changed) {
        by_change_.erase(tile.change);
        tile.change = ++version_;
        by_change_.emplace(tile.change, &tile);
    }
}

bool ShownMap::fresh_for(std::uint64_t& reader) const {
    const bool fresh = reader < begun_;
    reader = std::max(reader, begun_);
    return fresh;
}

const TileImage* ShownMap::next(std::uint64_t& reader) const {
    const auto change = by_change_.upper_bound(reader);
    if (change == by_change_.end()) {
        return nullptr;
    }
    reader = change->first;
    return &change->second->image;
}

}  // namespace crspf
