#include "core/slam/roaming_map.hpp"

#include <catch2/catch.hpp>
#include <cstring>
#include <map>
#include <memory>
#include <utility>
#include <vector>

#include "core/slam/match_field.hpp"
#include "tests/unit/core/synthetic.hpp"

using namespace crspf;
using namespace crspf::test;

namespace {

constexpr std::int32_t kSide = TileGeometry::kSide;

constexpr std::int64_t square(std::int64_t v) {
    return v * v;
}

using Tiles = std::map<std::pair<std::int32_t, std::int32_t>, TileCells>;  // by y, x

/// Keeps tiles in memory, and gives them back when they are near.
class Keeper {
 public:
    void turn(TileRings& rings) {
        while (const TileRecord* const record = rings.away.front()) {
            if (record->kind == TileRecord::Kind::kTile) {
                kept_[{record->cell.y, record->cell.x}] = record->cells;
            } else {
                give_back(record->cell, record->within, rings);
            }
            rings.away.pop();
        }
    }
    [[nodiscard]] const Tiles& kept() const { return kept_; }
    [[nodiscard]] std::size_t given_back() const { return given_back_; }

 private:
    void give_back(Cell robot, std::int32_t within, TileRings& rings) {
        for (auto tile = kept_.begin(); tile != kept_.end();) {
            const Cell corner{.x = tile->first.second, .y = tile->first.first};
            if (squared_distance(corner, robot) <= square(within) && !rings.back.full()) {
                rings.back.push({.cell = corner, .cells = tile->second});
                tile = kept_.erase(tile);
                ++given_back_;
            } else {
                ++tile;
            }
        }
    }
    Tiles kept_;
    std::size_t given_back_ = 0;
};

/// A robot that draws its surroundings: walls to both sides, different at each place.
class Roamer {
 public:
    explicit Roamer(bool with_keeper) : with_keeper_(with_keeper) {}

    void go_to(double x_m) {
        const Pose2 P{.x_m = x_m, .y_m = 0.0, .theta_rad = 0.0};
        points_->count = 0;
        const double wall_m = 12.0 + std::fmod(std::abs(x_m), 7.0);
        for (int i = -30; i <= 30; ++i) {
            for (const double side_m : {-wall_m, wall_m}) {
                const std::uint32_t k = points_->count++;
                points_->x_m[k] = static_cast<float>(0.4 * i);
                points_->y_m[k] = static_cast<float>(side_m);
                points_->range_m[k] = static_cast<float>(std::hypot(0.4 * i, side_m));
                points_->beam[k] = static_cast<std::uint16_t>(k);
            }
        }
        points_->beams = points_->count;
        tiles_ = next_tiles(*rings_, tiles_);
        changes_->clear();
        roaming_->update({.P_map_base = P,
                          .draw = true,
                          .tidy = with_keeper_ && room_to_tidy(*rings_, 0),
                          .sight_m = sight_of(*points_),
                          .tiles = tiles_},
                         *points_, *changes_);
        field_->follow(*changes_);
        if (with_keeper_) {
            keeper_.turn(*rings_);
        }
        most_tiles_ = std::max(most_tiles_, roaming_->map().tiles());
        most_field_tiles_ = std::max(most_field_tiles_, field_->tiles().tiles());
    }
    [[nodiscard]] const OccupancyMap& map() const { return roaming_->map(); }
    [[nodiscard]] const MatchField& field() const { return *field_; }
    [[nodiscard]] const Keeper& keeper() const { return keeper_; }
    [[nodiscard]] std::size_t most_tiles() const { return most_tiles_; }
    [[nodiscard]] std::size_t most_field_tiles() const { return most_field_tiles_; }

 private:
    bool with_keeper_;
    std::unique_ptr<TileRings> rings_ = std::make_unique<TileRings>();
    std::unique_ptr<RoamingMap> roaming_ = make_large<RoamingMap>(SlamParams{}, *rings_);
    std::unique_ptr<MatchField> field_ = make_large<MatchField>();
    std::unique_ptr<ChangeList> changes_ = std::make_unique<ChangeList>();
    std::unique_ptr<ScanPoints> points_ = std::make_unique<ScanPoints>();
    Keeper keeper_;
    std::uint32_t tiles_ = 0;
    std::size_t most_tiles_ = 0;
    std::size_t most_field_tiles_ = 0;
};

/// Cells near x that the map has, with what the field says of them.
std::size_t differences_near(const Roamer& a, const Tiles& tiles, double x_m) {
    std::size_t different = 0;
    const auto middle = static_cast<std::int32_t>(x_m / SlamParams{}.map.resolution_m);
    for (const auto& [key, cells] : tiles) {
        const Cell corner{.x = key.second, .y = key.first};
        if (squared_distance(corner, {.x = middle, .y = 0}) > square(std::int64_t{2} * kSide)) {
            continue;
        }
        for (std::int32_t i = 0; i < kSide * kSide; ++i) {
            const Cell cell{.x = corner.x + i % kSide, .y = corner.y + i / kSide};
            different += a.map().at(cell) == cells[TileGeometry::offset(cell)] ? 0U : 1U;
        }
    }
    return different;
}

Tiles tiles_of(const OccupancyMap& map) {
    Tiles tiles;
    map.for_each_tile([&](Cell corner, const OccupancyTile& tile) { tiles[{corner.y, corner.x}] = tile.cells; });
    return tiles;
}

/// Whether the field is the one that the map's cells make: there is no trace of what has gone.
std::size_t wrong_field_cells(const Roamer& roamer) {
    const auto fresh = make_large<MatchField>();
    std::size_t wrong = 0;
    roamer.map().for_each_tile([&](Cell corner, const OccupancyTile& tile) {
        for (std::int32_t i = 0; i < kSide * kSide; ++i) {
            const Cell cell{.x = corner.x + i % kSide, .y = corner.y + i / kSide};
            const CellChange change{.cell = cell, .before = kUnseen, .after = tile.cells[TileGeometry::offset(cell)]};
            if (change.after != kUnseen) {
                fresh->follow({&change, 1});
            }
        }
    });
    fresh->tiles().for_each_tile([&](Cell corner, const FieldTile& tile) {
        const FieldTile* const other = roamer.field().tiles().find(corner);
        wrong += other != nullptr && other->cells == tile.cells ? 0U : 1U;
    });
    return wrong + (fresh->tiles().tiles() == roamer.field().tiles().tiles() ? 0U : 1U);
}

}  // namespace

TEST_CASE("roaming map: the pool is enough for any way, what is far is kept, and comes back as it was") {
    Roamer roamer(true);
    // 1 km along x: 40 m wide, some 25 000 tiles of 1.28 m.
    for (int i = 0; i < 1000; ++i) {
        roamer.go_to(0.4 * i);
        if (i == 50) {
            REQUIRE(roamer.keeper().kept().empty());
        }
    }
    CHECK(roamer.map().refused() == 0);
    CHECK(roamer.field().tiles().refused() == 0);
    CHECK(roamer.most_tiles() < capacity::kTilesKept + 200);
    CHECK(roamer.keeper().kept().size() > 1000);
    CHECK(wrong_field_cells(roamer) == 0);
    const Tiles before = roamer.keeper().kept();
    REQUIRE(before.contains({0, 0}));

    // Back: its beginning is there before it is seen, as it was.
    CHECK(differences_near(roamer, before, 10.0) > 1000);
    for (int i = 0; i < 748; ++i) {
        roamer.go_to(400.0 - 0.5 * i);
    }
    for (int i = 0; i < 20; ++i) {  // what is on its way arrives
        roamer.go_to(26.0);
    }
    CHECK(differences_near(roamer, before, 10.0) == 0);
    CHECK(roamer.keeper().given_back() > 1000);
    CHECK(roamer.map().refused() == 0);
    CHECK(wrong_field_cells(roamer) == 0);
    // Every tile that there ever was is with the one or with the other.
    Tiles all = roamer.keeper().kept();
    all.merge(tiles_of(roamer.map()));
    std::size_t missing = 0;
    for (const auto& [key, cells] : before) {
        missing += all.contains(key) ? 0U : 1U;
    }
    CHECK(missing == 0);
}

TEST_CASE("roaming map: what comes back fills in only what has not been seen anew") {
    const auto rings = std::make_unique<TileRings>();
    const auto roaming = make_large<RoamingMap>(SlamParams{}, *rings);
    const auto changes = std::make_unique<ChangeList>();
    const auto field = make_large<MatchField>();
    TileRecord tile{.cell = {.x = kSide, .y = 0}, .cells = {}};
    tile.cells[0] = 200;
    tile.cells[1] = kFreeCell;
    changes->clear();
    roaming->load(tile, *changes);
    field->follow(*changes);
    tile.cells[0] = kFreeCell;
    tile.cells[2] = 100;
    REQUIRE(rings->back.push(tile));
    changes->clear();
    roaming->update({.P_map_base = {}, .tiles = next_tiles(*rings, 0)}, *std::make_unique<ScanPoints>(), *changes);
    field->follow(*changes);
    CHECK(roaming->map().at({.x = kSide, .y = 0}) == 200);
    CHECK(roaming->map().at({.x = kSide + 1, .y = 0}) == kFreeCell);
    CHECK(roaming->map().at({.x = kSide + 2, .y = 0}) == 100);
    CHECK(field->at({.x = kSide, .y = 0}) == 3 * 200 + 100);
    CHECK(field->seen({.x = kSide + 1, .y = 0}));
    CHECK_FALSE(field->seen({.x = kSide + 3, .y = 0}));
}

TEST_CASE("roaming map: without a keeper the pool ends, and nothing is lost of what it has") {
    Roamer roamer(false);
    for (int i = 0; i < 1250; ++i) {
        roamer.go_to(0.4 * i);
    }
    CHECK(roamer.map().full());
    CHECK(roamer.map().refused() > 0);
    CHECK(roamer.map().at({.x = 0, .y = 0}) == kFreeCell);
}

TEST_CASE("roaming map: a ring without room sends nothing away") {
    const auto rings = std::make_unique<TileRings>();
    CHECK(room_to_tidy(*rings, 3));
    for (int i = 0; i < 100; ++i) {
        REQUIRE(rings->away.push({}));
    }
    CHECK(room_to_tidy(*rings, 0));
    CHECK_FALSE(room_to_tidy(*rings, 1));
    // As many at once as a list of changes holds.
    for (int i = 0; i < 40; ++i) {
        REQUIRE(rings->back.push({}));
    }
    CHECK(next_tiles(*rings, 0) == 16);
    CHECK(next_tiles(*rings, 32) == 40);
    CHECK(next_tiles(*rings, 40) == 40);
}
