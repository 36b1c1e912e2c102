#include "platform/service/shown_map.hpp"

#include <catch2/catch.hpp>
#include <vector>

using namespace crspf;

namespace {

TileImage tile_at(std::int32_t column, std::uint8_t percent) {
    TileImage tile{.corner = {.x = column * TileGeometry::kSide, .y = 0}};
    tile.cells.fill(percent);
    return tile;
}

/// The columns of the tiles that a reader has not had.
std::vector<std::int32_t> news(const ShownMap& map, std::uint64_t& reader) {
    std::vector<std::int32_t> columns;
    while (const TileImage* const tile = map.next(reader)) {
        columns.push_back(tile->corner.x / TileGeometry::kSide);
    }
    return columns;
}

using Columns = std::vector<std::int32_t>;

}  // namespace

TEST_CASE(
    "shown map: each reader gets what has changed since it asked last, the oldest change first, and each tile once") {
    ShownMap map;
    map.begin();
    std::uint64_t early = 0;
    CHECK(map.fresh_for(early));
    map.take(tile_at(0, 10));
    map.take(tile_at(1, 20));
    CHECK(news(map, early) == Columns{0, 1});
    CHECK(early == map.version());

    map.take(tile_at(0, 30));
    map.take(tile_at(2, 0));
    map.take(tile_at(0, 40));
    CHECK_FALSE(map.fresh_for(early));
    CHECK(news(map, early) == Columns{2, 0});
    std::uint64_t late = 0;
    CHECK(map.fresh_for(late));
    CHECK(news(map, late) == Columns{1, 2, 0});
    CHECK(news(map, late).empty());
}

TEST_CASE("shown map: what a tile does not see it does not take away, and what is as it was is no change") {
    ShownMap map;
    map.begin();
    map.take(tile_at(0, 10));
    std::uint64_t reader = map.version();
    map.take(tile_at(0, TileImage::kUnseen));
    map.take(tile_at(0, 10));
    CHECK(news(map, reader).empty());
    TileImage corner = tile_at(0, TileImage::kUnseen);
    corner.cells[7] = 90;
    map.take(corner);
    const TileImage* const tile = map.next(reader);
    REQUIRE(tile != nullptr);
    CHECK(tile->cells[7] == 90);
    CHECK(tile->cells[8] == 10);
}

TEST_CASE("shown map: another map is news to whoever knew the one before, and tiles outside the plane are left out") {
    ShownMap map;
    map.begin();
    map.take(tile_at(0, 10));
    std::uint64_t reader = 0;
    CHECK(map.fresh_for(reader));
    CHECK(news(map, reader) == Columns{0});
    map.begin();
    CHECK(map.empty());
    CHECK(reader < map.version());
    CHECK(map.fresh_for(reader));
    CHECK(news(map, reader).empty());
    map.take(tile_at(TileGeometry::kHalf / TileGeometry::kSide, 10));
    CHECK(map.empty());
    map.take(tile_at(TileGeometry::kHalf / TileGeometry::kSide - 1, 10));  // the control: the last one inside
    CHECK_FALSE(map.empty());
}

TEST_CASE("shown map: evidence becomes percent, unseen stays so") {
    TileCells cells;
    cells.fill(kUnseen);
    cells[0] = kOccupiedCell;
    cells[1] = kFreeCell;
    const TileImage image = image_of({.x = 64, .y = -64}, cells);
    CHECK(image.corner == Cell{.x = 64, .y = -64});
    CHECK(image.cells[0] == 100);
    CHECK(image.cells[1] == 0);
    CHECK(image.cells[2] == TileImage::kUnseen);
}
