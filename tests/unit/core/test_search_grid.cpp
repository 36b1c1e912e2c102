#include <algorithm>
#include <catch2/catch.hpp>
#include <vector>

#include "core/slam/search_grid.hpp"
#include "tests/unit/core/synthetic.hpp"

using namespace crspf;
using namespace crspf::test;

namespace {

MapView view_of(const std::vector<Evidence>& cells, std::int32_t width, std::int32_t height) {
    return {.cells = cells, .width = width, .height = height, .resolution_m = 0.05, .P_map_corner = {}};
}

}  // namespace

TEST_CASE("a coarse cell is a wall where one of its cells is, free where one is free and none a wall") {
    // Two by two: unseen, free beside unseen, free beside a wall, nothing but walls; and half a cell at the edge.
    const std::vector<Evidence> cells{kUnseen, kUnseen, kFreeCell, kUnseen, kFreeCell,     kFreeCell, 255, 255, 200,
                                      kUnseen, kUnseen, kUnseen,   kUnseen, kOccupiedFrom, kFreeCell, 255, 255, 127};
    const MapView map = view_of(cells, 9, 2);
    std::vector<std::uint8_t> memory(SearchGrid::bytes_needed(map, 2));
    SearchGrid grid;
    REQUIRE(grid.build(map, 2, memory));
    CHECK(grid.width() == 8);
    CHECK(grid.height() == 4);
    CHECK(grid.at(Layer::kHit, 0, 0) == 0);
    CHECK(grid.at(Layer::kHit, 1, 0) == kWorth / 2);  // beside a wall
    CHECK(grid.at(Layer::kHit, 2, 0) == kWorth);
    CHECK(grid.at(Layer::kHit, 3, 0) == kWorth);
    CHECK(grid.at(Layer::kHit, 4, 0) == kWorth);
    CHECK(grid.at(Layer::kHit, 4, 1) == kWorth / 2);
    CHECK(grid.at(Layer::kHit, 4, 2) == 0);
    CHECK(grid.at(Layer::kFree, 0, 0) == 0);
    CHECK(grid.can_stand(1, 0));
    CHECK_FALSE(grid.can_stand(2, 0));
    CHECK_FALSE(grid.can_stand(4, 0));
    CHECK(grid.at(Layer::kHit, -1, 0) == 0);
    CHECK(grid.at(Layer::kHit, 8, 0) == 0);
    CHECK(grid.at(Layer::kHit, 0, 4) == 0);
}

TEST_CASE("a block holds the best of the sixteen cells that begin at it, over the edges too") {
    Rng rng(11);
    std::vector<Evidence> cells(std::size_t{37} * 23);
    for (Evidence& cell : cells) {
        cell = whole(rng, 0, 9) == 0 ? kOccupiedCell : whole(rng, 0, 3) == 0 ? kFreeCell : kUnseen;
    }
    const MapView map = view_of(cells, 37, 23);
    std::vector<std::uint8_t> memory(SearchGrid::bytes_needed(map, 1));
    SearchGrid grid;
    REQUIRE(grid.build(map, 1, memory));
    constexpr std::int32_t kBlock = SearchGrid::kBlock;
    bool all = true;
    int kinds = 0;
    for (const Layer layer : {Layer::kHit, Layer::kFree}) {
        for (std::int32_t phase = 0; phase < kBlock * kBlock; ++phase) {
            for (std::int32_t by = -1; by < grid.height() / kBlock; ++by) {
                for (std::int32_t bx = -1; bx < grid.width() / kBlock; ++bx) {
                    int most = 0;
                    for (std::int32_t k = 0; k < kBlock * kBlock; ++k) {
                        most = std::max(most, grid.at(layer, kBlock * bx + phase % kBlock + k % kBlock,
                                                      kBlock * by + phase / kBlock + k / kBlock));
                    }
                    all = all && grid.block_row(layer, phase, by)[bx + 1] == most;
                    kinds |= 1 << most;
                }
            }
        }
    }
    CHECK(all);
    CHECK(kinds == ((1 << 0) | (1 << (kWorth / 2)) | (1 << kWorth)));  // there was something to hold
}

TEST_CASE("the grid stays within its memory and refuses what is no map") {
    const std::vector<Evidence> cells(50, kFreeCell);
    const MapView map = view_of(cells, 10, 5);
    const std::size_t bytes = SearchGrid::bytes_needed(map, 2);
    std::vector<std::uint8_t> memory(bytes + 1, 99);
    SearchGrid grid;
    CHECK_FALSE(grid.build(map, 2, std::span(memory).first(bytes - 1)));
    CHECK(grid.build(map, 2, std::span(memory).first(bytes)));
    CHECK(memory.back() == 99);
    CHECK(memory[bytes - 1] != 99);

    CHECK_FALSE(grid.build(view_of(cells, 10, 6), 2, memory));  // not so many cells
    CHECK_FALSE(grid.build(view_of(cells, -10, -5), 2, memory));
    CHECK_FALSE(grid.build(view_of({}, 0, 0), 2, memory));
    CHECK_FALSE(grid.build(map, 0, memory));
    CHECK(SearchGrid::bytes_needed(view_of({}, 0, 0), 2) == 0);
}
