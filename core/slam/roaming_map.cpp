#include "core/slam/roaming_map.hpp"

#include <algorithm>
#include <array>
#include <cstddef>
#include <utility>

namespace crspf {
namespace {

constexpr std::int32_t kSide = TileGeometry::kSide;
constexpr std::size_t kEachWay = ChangeList::kTilesEachWay;
static_assert(capacity::kTilesKept + kEachWay < capacity::kTiles);
/// Beyond the robot's sight, that tiles are back before they are seen.
constexpr std::int32_t kAhead = 2 * kSide;
/// Between where a tile comes back and where it may go: one that has come does not go again at once.
constexpr std::int32_t kApart = 8 * kSide;

}  // namespace

double sight_of(const ScanPoints& points) {
    float sight_m = 0.0F;
    for (std::uint32_t i = 0; i < points.count; ++i) {
        sight_m = std::max(sight_m, points.range_m[i]);
    }
    for (std::uint32_t i = 0; i < points.clear_count; ++i) {
        sight_m = std::max(sight_m, points.clear_m[i]);
    }
    return static_cast<double>(sight_m);
}

bool room_to_tidy(const TileRings& rings, std::size_t before) {
    constexpr std::size_t kRecords = kEachWay + 1;  // of one update
    return rings.away.size() + (before + 1) * kRecords <= decltype(rings.away)::kCapacity;
}

std::uint32_t next_tiles(const TileRings& rings, std::uint32_t tiles) {
    return tiles + std::min(rings.back.committed() - tiles, std::uint32_t{kEachWay});
}

void RoamingMap::update(const MapTask& task, const ScanPoints& points, ChangeList& changes) {
    take_back(task.tiles, changes);
    if (task.draw) {
        update_.draw(points, task.P_map_base, task.key_frame, changes);
    }
    sight_m_ = std::max(sight_m_, task.sight_m);
    if (task.tidy) {
        send_away({.x = floor_to_cell(task.P_map_base.x_m * cells_per_metre_),
                   .y = floor_to_cell(task.P_map_base.y_m * cells_per_metre_)},
                  floor_to_cell(std::min(sight_m_ * cells_per_metre_, double{TileGeometry::kHalf})), changes);
    }
}

void RoamingMap::take_back(std::uint32_t tiles, ChangeList& changes) {
    for (std::size_t i = 0; i < kEachWay && taken_ != tiles && !map().full(); ++i) {
        const TileRecord* const tile = rings_.back.front();
        if (tile == nullptr) {
            return;  // not before a replay whose recording has a gap
        }
        update_.restore(tile->cell, tile->cells, changes);
        rings_.back.pop();
        ++taken_;
    }
}

void RoamingMap::send_away(Cell robot, std::int32_t sight, ChangeList& changes) {
    const std::int32_t within = sight + kAhead;
    if (TileRecord* const record = rings_.away.claim()) {
        record->kind = TileRecord::Kind::kRobot;
        record->cell = robot;
        record->within = within;
        rings_.away.commit();
    }
    if (map().tiles() <= capacity::kTilesKept) {
        return;
    }
    // The farthest, in descending order.
    std::array<std::pair<std::int64_t, Cell>, kEachWay> farthest{};
    const std::int64_t beyond = within + kApart;
    farthest.fill({beyond * beyond, Cell{}});
    std::size_t found = 0;
    map().for_each_tile([&](Cell corner, const OccupancyTile& /*tile*/) {
        const std::int64_t distance = squared_distance(corner, robot);
        if (distance > farthest.back().first) {
            auto* const place = std::upper_bound(farthest.begin(), farthest.end(), distance,
                                                 [](std::int64_t d, const auto& other) { return d > other.first; });
            std::move_backward(place, farthest.end() - 1, farthest.end());
            *place = {distance, corner};
            found = std::min(found + 1, kEachWay);
        }
    });
    for (std::size_t i = 0; i < found; ++i) {
        const Cell corner = farthest[i].second;
        const OccupancyTile* const tile = map().find(corner);
        TileRecord* const record = tile != nullptr ? rings_.away.claim() : nullptr;
        if (record == nullptr) {
            return;  // not where room_to_tidy() was asked
        }
        record->kind = TileRecord::Kind::kTile;
        record->cell = corner;
        record->cells = tile->cells;
        rings_.away.commit();
        update_.forget(corner, changes);
    }
}

}  // namespace crspf
