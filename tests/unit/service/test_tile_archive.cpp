#include "platform/service/tile_archive.hpp"

#include <algorithm>
#include <catch2/catch.hpp>
#include <filesystem>
#include <memory>
#include <random>
#include <vector>

#include "platform/service/map_image.hpp"
#include "tests/unit/platform/scratch.hpp"

using namespace crspf;
using crspf::test::Scratch;

namespace {

constexpr std::int32_t kSide = TileGeometry::kSide;

TileCells filled(Evidence evidence) {
    TileCells cells;
    cells.fill(evidence);
    return cells;
}

TileRecord robot_at(Cell cell, std::int32_t within) {
    return {.kind = TileRecord::Kind::kRobot, .cell = cell, .within = within, .cells = {}};
}

/// Where the tile of `n` lies: a row of them, in no order.
Cell corner_of(int n) {
    return {.x = (n * 37 % 101 - 50) * kSide, .y = (n % 3 - 1) * kSide};
}

std::vector<TileRecord> taken(TileRings& rings) {
    std::vector<TileRecord> records;
    for (TileRecord record; rings.back.pop(record);) {
        records.push_back(record);
    }
    return records;
}

}  // namespace

TEST_CASE("tile archive: what was sent away comes back, nearest first, when the robot is near it, once") {
    const Scratch scratch;
    TileArchive archive(scratch.directory());
    const auto rings = std::make_unique<TileRings>();
    for (int n = 0; n < 100; ++n) {
        REQUIRE(rings->away.push({.cell = corner_of(n), .cells = filled(static_cast<Evidence>(n + 1))}));
    }
    archive.turn(*rings);
    CHECK(taken(*rings).empty());
    CHECK(archive.state().tiles == 100);
    CHECK(archive.state().problem.empty());
    CHECK(std::filesystem::is_empty(scratch.directory()));  // the file has no name

    const Cell robot{.x = 20 * kSide, .y = 0};
    REQUIRE(rings->away.push(robot_at(robot, 5 * kSide)));
    archive.turn(*rings);
    const std::vector<TileRecord> back = taken(*rings);
    CHECK(back.size() > 6);
    std::int64_t farthest = 0;
    for (const TileRecord& record : back) {
        const std::int64_t distance = squared_distance(record.cell, robot);
        CHECK(distance >= farthest);
        farthest = distance;
        int n = 0;
        while (!(corner_of(n) == record.cell)) {
            ++n;
        }
        CHECK(record.cells == filled(static_cast<Evidence>(n + 1)));
    }
    CHECK(farthest <= std::int64_t{5} * kSide * 5 * kSide);
    REQUIRE(rings->away.push(robot_at(robot, 5 * kSide)));
    archive.turn(*rings);
    CHECK(taken(*rings).empty());
    CHECK(archive.state().brought_back == back.size());
    std::size_t all = 0;
    archive.for_each_tile([&all](Cell /*corner*/, const TileCells& /*cells*/) { ++all; });
    CHECK(all == 100);
}

TEST_CASE("tile archive: a tile that was not back in time keeps what was known of it") {
    const Scratch scratch;
    TileArchive archive(scratch.directory());
    TileCells before = filled(kFreeCell);
    before[7] = 200;
    archive.keep({.x = 0, .y = 0}, before);
    TileCells anew = filled(kUnseen);
    anew[8] = 90;
    archive.keep({.x = 0, .y = 0}, anew);
    TileCells expected = before;
    expected[8] = 90;
    archive.for_each_tile([&](Cell /*corner*/, const TileCells& cells) { CHECK(cells == expected); });
    CHECK(archive.state().tiles == 1);
}

TEST_CASE("tile archive: the same in the same order, whenever it has its turn") {
    std::mt19937 random(5);  // NOLINT(cert-msc32-c,cert-msc51-cpp): the same each time
    std::vector<TileRecord> sent;
    for (int i = 0; i < 2000; ++i) {
        if (i % 4 == 3) {
            sent.push_back(
                robot_at({.x = static_cast<std::int32_t>(random() % 100) * kSide - 50 * kSide, .y = 0}, 6 * kSide));
        } else {
            sent.push_back({.cell = corner_of(static_cast<int>(random() % 101)),
                            .cells = filled(static_cast<Evidence>(random() % 255 + 1))});
        }
    }
    std::vector<std::vector<TileRecord>> came;
    for (const unsigned lateness : {1U, 7U, 60U}) {
        const Scratch scratch;
        TileArchive archive(scratch.directory());
        const auto rings = std::make_unique<TileRings>();
        std::vector<TileRecord>& all = came.emplace_back();
        unsigned since = 0;
        for (const TileRecord& record : sent) {
            REQUIRE(rings->away.push(record));
            if (++since >= lateness) {
                archive.turn(*rings);
                if (lateness != 7 || random() % 2 == 0) {  // the map is late, too: its ring is full at times
                    const std::vector<TileRecord> some = taken(*rings);
                    all.insert(all.end(), some.begin(), some.end());
                }
                since = 0;
            }
        }
        for (int i = 0; i < 30; ++i) {
            archive.turn(*rings);
            const std::vector<TileRecord> some = taken(*rings);
            all.insert(all.end(), some.begin(), some.end());
        }
    }
    REQUIRE(came[0].size() > 300);
    for (const std::vector<TileRecord>& other : came) {
        CHECK(std::equal(
            came[0].begin(), came[0].end(), other.begin(), other.end(),
            [](const TileRecord& a, const TileRecord& b) { return a.cell == b.cell && a.cells == b.cells; }));
    }
}

TEST_CASE("tile archive: a disk that does not take them loses nothing, and says so") {
    TileArchive archive("/proc/no/such/directory");
    const auto rings = std::make_unique<TileRings>();
    for (int n = 0; n < 20; ++n) {
        REQUIRE(rings->away.push({.cell = corner_of(n), .cells = filled(static_cast<Evidence>(n + 1))}));
    }
    archive.turn(*rings);
    CHECK(archive.state().in_memory == 20);
    CHECK_THAT(archive.state().problem, Catch::Contains("/proc/no/such/directory") && Catch::Contains("memory"));
    REQUIRE(rings->away.push(robot_at({.x = 0, .y = 0}, 100 * kSide)));
    archive.turn(*rings);
    CHECK(taken(*rings).size() == 20);
    CHECK(archive.state().lost == 0);
}

TEST_CASE("a map too large for a file is exported in coarser cells, and a wall wins") {
    const Cell far{.x = TileGeometry::kHalf - kSide, .y = 100 * kSide};
    TileCells wall = filled(kFreeCell);
    wall[0] = kOccupiedCell;
    const auto tiles = [&](const TileVisitor& visit) {
        visit({.x = -TileGeometry::kHalf, .y = 0}, filled(kFreeCell));
        visit(far, wall);
    };
    const GridMap map = export_map(tiles, 0.05);
    CHECK(map.resolution_m == 0.1);
    CHECK(map.width == TileGeometry::kHalf);
    CHECK(map.height == 101 * kSide / 2);
    CHECK(map.at(0, 0) == GridCell::kFree);
    CHECK(map.at(map.width - kSide / 2, map.height - kSide / 2) == GridCell::kOccupied);
    CHECK(map.at(map.width - 1, map.height - 1) == GridCell::kFree);
    CHECK(map.at(map.width - 1, 0) == GridCell::kUnknown);
}
