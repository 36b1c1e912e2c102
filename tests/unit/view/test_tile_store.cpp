#include "tools/view/tile_store.hpp"

#include <catch2/catch.hpp>

#include "platform/files/base64.hpp"
#include "tests/unit/view/view_events.hpp"

using namespace crspf::view;
using namespace crspf::view::test;
using crspf::from_base64;
using crspf::TileImage;

namespace {

std::vector<std::string> corners(const Json& message) {
    std::vector<std::string> found;
    for (const Json& tile : message["tiles"]) {
        found.push_back(std::to_string(tile["x"].get<int>() / 64) + "," + std::to_string(tile["y"].get<int>() / 64));
    }
    return found;
}

using Corners = std::vector<std::string>;

}  // namespace

TEST_CASE("tile store: a reader gets the tiles that have changed since it asked last, and each once") {
    TileStore store;
    CHECK(store.version() == 0);
    store.take({.fresh = true, .resolution_m = 0.1, .tiles = {tile_at(0, 0, 10), tile_at(-1, 0, 20)}});
    std::uint64_t cursor = 0;
    Json message = store.changes_since(cursor, 5);
    CHECK(message["fresh"] == true);
    CHECK(message["resolution_m"] == 0.1);
    CHECK(corners(message) == Corners{"0,0", "-1,0"});
    CHECK(cursor == store.version());

    store.take({.resolution_m = 0.1, .tiles = {tile_at(-1, 0, 30), tile_at(2, 1, 0), tile_at(-1, 0, 40)}});
    message = store.changes_since(cursor, 6);
    CHECK(message["fresh"] == false);
    CHECK(corners(message) == Corners{"2,1", "-1,0"});
    const auto cells = from_base64(message["tiles"][1]["data"].get<std::string>());
    REQUIRE(cells);
    CHECK(*cells == std::vector<std::uint8_t>(crspf::TileGeometry::kCells, 40));
    CHECK(cursor == store.version());
    std::uint64_t newcomer = 0;
    CHECK(corners(store.changes_since(newcomer, 7)).size() == 3);
}

TEST_CASE("tile store: a large map comes in messages of bounded size, and goes on where a reader stood") {
    TileStore store;
    TilesEvent event{.fresh = true, .resolution_m = 0.1, .tiles = {}};
    for (int i = 0; i < 100; ++i) {
        event.tiles.push_back(tile_at(i, i, 0));
    }
    store.take(event);
    std::uint64_t cursor = 0;
    std::size_t tiles = 0;
    std::size_t fresh = 0;
    while (cursor < store.version()) {
        const Json message = store.changes_since(cursor, 0);
        CHECK(message["tiles"].size() <= TileStore::kTilesAtOnce);
        tiles += message["tiles"].size();
        fresh += message["fresh"] == true ? 1U : 0U;
    }
    CHECK(tiles == 100);
    CHECK(fresh == 1);
}

TEST_CASE("tile store: another map makes those who know the old one forget it") {
    TileStore store;
    store.take({.fresh = true, .resolution_m = 0.1, .tiles = {tile_at(0, 0, 10)}});
    std::uint64_t cursor = 0;
    static_cast<void>(store.changes_since(cursor, 0));
    store.take({.fresh = true, .resolution_m = 0.2, .tiles = {}});
    REQUIRE(cursor < store.version());
    const Json message = store.changes_since(cursor, 0);
    CHECK(message["fresh"] == true);
    CHECK(message["resolution_m"] == 0.2);
    CHECK(message["tiles"].empty());
    CHECK(cursor == store.version());
    CHECK(store.empty());
}

TEST_CASE("tile store: tiles outside the plane are left out") {
    TileStore store;
    TileImage far = tile_at(0, 0, 10);
    far.corner.x = crspf::TileGeometry::kHalf;
    store.take({.fresh = true, .resolution_m = 0.1, .tiles = {far}});
    CHECK(store.empty());
}

TEST_CASE("tile store: a picture of the whole map, coarser where that would be too large, walls first") {
    TileStore store;
    TileImage wall = tile_at(1, 1, 0);
    wall.cells[crspf::TileGeometry::offset({.x = 64 + 3, .y = 64 + 2})] = 90;
    store.take({.fresh = true, .resolution_m = 0.1, .tiles = {tile_at(-1, 0, 10), wall}});
    GridPicture picture = store.picture();
    CHECK(picture.columns == 3 * 64);
    CHECK(picture.cells.size() == 6 * crspf::TileGeometry::kCells);
    CHECK(picture.cell_m == 0.1);
    CHECK(picture.P_map_corner.x_m == Approx(-6.4));
    CHECK(picture.P_map_corner.y_m == 0.0);
    const auto at = [&](std::size_t x, std::size_t y) { return picture.cells[y * picture.columns + x]; };
    CHECK(at(0, 0) == 10);
    CHECK(at(64, 0) == TileImage::kUnseen);
    CHECK(at(128 + 3, 64 + 2) == 90);
    CHECK(at(128 + 4, 64 + 2) == 0);

    store.take({.resolution_m = 0.1, .tiles = {tile_at(100, 50, 0)}});
    picture = store.picture();
    CHECK(picture.cells.size() <= TileStore::kPictureCellsMax);
    CHECK(picture.cell_m == Approx(0.4));
    CHECK(at((128 + 3) / 4, (64 + 2) / 4) == 90);
    CHECK(at(20, 0) == TileImage::kUnseen);
}
