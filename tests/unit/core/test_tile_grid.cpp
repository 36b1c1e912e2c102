#include <array>
#include <catch2/catch.hpp>
#include <cmath>
#include <map>
#include <utility>
#include <vector>

#include "core/slam/tile_grid.hpp"
#include "tests/unit/core/synthetic.hpp"

using namespace crspf;
using namespace crspf::test;

namespace {

struct ByteTile {
    std::array<std::uint8_t, TileGeometry::kCells> cells;
};
using Grid = TileGrid<ByteTile>;
constexpr std::int32_t kHalf = TileGeometry::kHalf;
constexpr std::int32_t kSide = TileGeometry::kSide;

void write(Grid& grid, Cell c, std::uint8_t value) {
    auto* tile = grid.touch(c);
    REQUIRE(tile != nullptr);
    tile->cells[TileGeometry::offset(c)] = value;
}

}  // namespace

TEST_CASE("the cell of a coordinate is below it, on both sides of zero") {
    CHECK(floor_to_cell(0.0) == 0);
    CHECK(floor_to_cell(0.999) == 0);
    CHECK(floor_to_cell(-1e-12) == -1);
    CHECK(floor_to_cell(-1.0) == -1);
    CHECK(floor_to_cell(-1.000001) == -2);
    Rng rng(41);
    for (int i = 0; i < 10000; ++i) {
        const double v = 70000.0 * rng.symmetric();
        REQUIRE(floor_to_cell(v) == static_cast<std::int32_t>(std::floor(v)));
    }
}

TEST_CASE("a grid keeps what was written, across tile borders and the origin, and nothing else") {
    auto grid = make_large<Grid>();
    std::map<std::pair<std::int32_t, std::int32_t>, std::uint8_t> expected;
    Rng rng(42);
    for (int i = 0; i < 5000; ++i) {
        const Cell c{.x = whole(rng, -130, 130), .y = whole(rng, -130, 130)};
        const auto value = static_cast<std::uint8_t>(rng.next());
        write(*grid, c, value);
        expected[{c.x, c.y}] = value;
    }
    for (std::int32_t y = -200; y <= 200; ++y) {
        for (std::int32_t x = -200; x <= 200; ++x) {
            const auto found = expected.find({x, y});
            const int value = found == expected.end() ? 0 : found->second;
            REQUIRE(int{grid->at({.x = x, .y = y})} == value);
        }
    }
    CHECK(grid->tiles() == 36);  // 6 x 6 tiles of 64 cover -130 .. 130
    CHECK(grid->refused() == 0);
}

TEST_CASE("the directory's edge: the last cells inside are kept, those outside refused and counted") {
    auto grid = make_large<Grid>();
    for (const std::int32_t inside_x : {-kHalf, kHalf - 1}) {
        for (const std::int32_t inside_y : {-kHalf, kHalf - 1}) {
            write(*grid, {.x = inside_x, .y = inside_y}, 9);
            CHECK(grid->at({.x = inside_x, .y = inside_y}) == 9);
        }
    }
    CHECK(grid->tiles() == 4);
    constexpr std::int32_t kFar = 2'000'000'000;
    std::uint64_t refused = 0;
    for (const Cell outside : {Cell{.x = -kHalf - 1, .y = 0}, Cell{.x = kHalf, .y = 0}, Cell{.x = 0, .y = -kHalf - 1},
                               Cell{.x = 0, .y = kHalf}, Cell{.x = kFar, .y = -kFar}}) {
        CHECK(grid->touch(outside) == nullptr);
        CHECK(grid->refused() == ++refused);
        CHECK(grid->at(outside) == 0);
    }
    CHECK(grid->tiles() == 4);
}

TEST_CASE("a used-up pool refuses and counts, what is there stays readable and writable") {
    auto grid = make_large<Grid>();
    constexpr std::size_t kRoom = capacity::kTiles - 1;  // tile 0 stays empty
    std::size_t made = 0;
    std::uint64_t refused = 0;
    for (std::int32_t i = 0; made + refused < kRoom + 100; ++i) {
        const Cell c{.x = (i % 128) * kSide, .y = (i / 128) * kSide};
        if (auto* tile = grid->touch(c)) {
            tile->cells[0] = static_cast<std::uint8_t>(i % 251 + 1);
            ++made;
        } else {
            ++refused;
        }
    }
    CHECK(made == kRoom);
    CHECK(grid->tiles() == kRoom);
    CHECK(grid->refused() == 100);
    for (std::int32_t i = 0; i < static_cast<std::int32_t>(kRoom); ++i) {
        REQUIRE(int{grid->at({.x = (i % 128) * kSide, .y = (i / 128) * kSide})} == i % 251 + 1);
    }
    const auto first_refused = static_cast<std::int32_t>(kRoom);
    CHECK(grid->at({.x = (first_refused % 128) * kSide, .y = (first_refused / 128) * kSide}) == 0);
    write(*grid, {.x = 5, .y = 5}, 77);
    CHECK(grid->at({.x = 5, .y = 5}) == 77);
    CHECK(grid->refused() == 100);
}

TEST_CASE("all tiles are visited once, in the order in which they were made") {
    auto grid = make_large<Grid>();
    const std::vector<Cell> corners{
        {.x = kSide, .y = -kSide}, {.x = -2 * kSide, .y = -kSide}, {.x = 0, .y = 0}, {.x = -kHalf, .y = kHalf - kSide}};
    for (const Cell corner : corners) {
        write(*grid, {.x = corner.x + 3, .y = corner.y + 2}, 5);
        write(*grid, {.x = corners[0].x, .y = corners[0].y}, 6);  // of a tile that is there
    }
    std::vector<Cell> visited;
    grid->for_each_tile([&](Cell corner, const ByteTile& tile) {
        visited.push_back(corner);
        CHECK(tile.cells[TileGeometry::offset({.x = 3, .y = 2})] == 5);
    });
    CHECK(visited == corners);
}

TEST_CASE("a tile that was released is empty, and its room is for another") {
    auto grid = make_large<Grid>();
    const std::array<Cell, 3> corners{{{.x = 0, .y = 0}, {.x = kSide, .y = 0}, {.x = 2 * kSide, .y = 0}}};
    for (const Cell corner : corners) {
        write(*grid, corner, 9);
    }
    grid->release(corners[1]);
    grid->release(corners[1]);            // there is none any longer
    grid->release({.x = kHalf, .y = 0});  // nor here
    CHECK(grid->tiles() == 2);
    CHECK(grid->at(corners[1]) == 0);
    CHECK(grid->find(corners[1]) == nullptr);
    CHECK(grid->at(corners[2]) == 9);
    std::vector<Cell> visited;
    const auto visit = [&visited](Cell corner, const ByteTile&) { visited.push_back(corner); };
    grid->for_each_tile(visit);
    CHECK(visited == std::vector<Cell>{corners[0], corners[2]});

    const Cell other{.x = -kSide, .y = kSide};
    write(*grid, {.x = other.x + 1, .y = other.y}, 4);
    CHECK(grid->at(other) == 0);  // nothing is left of the one before
    CHECK(grid->at({.x = other.x + 1, .y = other.y}) == 4);
    visited.clear();
    grid->for_each_tile(visit);
    CHECK(visited == std::vector<Cell>{corners[0], other, corners[2]});
    CHECK(grid->places() == 3);
}

TEST_CASE("a used-up pool takes another tile once one is released") {
    auto grid = make_large<Grid>();
    for (std::int32_t i = 0; !grid->full(); ++i) {
        write(*grid, {.x = (i % 128) * kSide, .y = (i / 128) * kSide}, 1);
    }
    CHECK(grid->touch({.x = -kSide, .y = 0}) == nullptr);
    grid->release({.x = 5 * kSide, .y = 3 * kSide});
    CHECK(grid->touch({.x = -kSide, .y = 0}) != nullptr);
    CHECK(grid->full());
    CHECK(grid->refused() == 1);
}
