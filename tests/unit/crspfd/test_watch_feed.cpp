// What the modules show to those who watch, and that nobody of them is disturbed by it.
#include <algorithm>
#include <catch2/catch.hpp>
#include <memory>
#include <vector>

#include "platform/crspfd/watch_feed.hpp"
#include "platform/service/tile_archive.hpp"
#include "tests/unit/crspfd/drive.hpp"
#include "tests/unit/crspfd/watched_map.hpp"
#include "tests/unit/platform/scratch.hpp"

using namespace crspf;
using namespace crspf::test;

namespace {

/// The modules, and the control thread's part of the watching.
class WatchedDrive {
 public:
    WatchedDrive() { board.watched(true); }

    void scan() {
        modules.wheels(drive);
        modules.scan(drive.scan());
        REQUIRE(modules.filter_turn());
        map_turns();
    }
    void map_turns() const {
        while (modules.map->turn()) {
        }
    }
    bool feed_turn() {
        now = now + Duration{20'000'000};
        return feed.turn(now, {}, board);
    }
    /// Until pictures show no change any longer.
    void settle() {
        for (int i = 0; i < 2000; ++i) {
            feed_turn();
            map_turns();
        }
    }
    /// Cells in which what he was told of the map is not what it is.
    [[nodiscard]] std::size_t different(const Watcher& watcher) {
        std::size_t count = 0;
        const auto compare = [&](Cell corner, const TileCells& cells) {
            const auto* const percent = watcher.map.at(corner);
            for (std::size_t i = 0; i < TileGeometry::kCells; ++i) {
                count += percent != nullptr && (*percent)[i] == percent_of(cells[i]) ? 0U : 1U;
            }
        };
        const OccupancyMap& map = modules.map->map();
        map.for_each_tile([&](Cell corner, const OccupancyTile& tile) { compare(corner, tile.cells); });
        far_tiles.for_each_tile([&](Cell corner, const TileCells& cells) {
            if (map.find(corner) == nullptr) {
                compare(corner, cells);
            }
        });
        return count;
    }

    Scratch scratch;
    Modules modules;
    Drive drive;
    TileArchive far_tiles{scratch.directory()};
    WatchFeed feed{*modules.exchange, far_tiles, params()};
    WatchBoard board;
    Stamp now{1'000'000'000};
};

}  // namespace

TEST_CASE("watch feed: scans and a growing map arrive, and a map that is saved meanwhile takes nothing away") {
    WatchedDrive w;
    Watcher watcher;
    for (int i = 0; i < 10; ++i) {
        w.scan();  // before it is looked at
    }
    std::size_t scans = 0;
    std::size_t copied = 0;
    for (int i = 0; i < 60; ++i) {
        w.scan();
        if (i % 7 == 0) {
            w.modules.exchange->copies_wanted.fetch_add(1);
        }
        for (int turn = 0; turn < 5; ++turn) {
            w.feed_turn();
            w.map_turns();
            while (w.modules.exchange->tiles.front() != nullptr) {
                w.modules.exchange->tiles.pop();
                ++copied;
            }
        }
        for (const view::ScanEvent& scan : only<view::ScanEvent>(watcher.all(w.board))) {
            const FilterState& state = w.modules.filter_state();
            CHECK(scan.stamp_ns == state.result.stamp.ns);
            CHECK(scan.P_map_base == state.result.P_map_base);
            CHECK(scan.M == state.result.M);
            CHECK(scan.rays == state.result.rays);
            CHECK(scan.points.size() >= scan.rays);
            const auto critical = std::count_if(scan.points.begin(), scan.points.end(),
                                                [](const view::ScanEvent::Point& point) { return point.critical; });
            CHECK(static_cast<std::size_t>(critical) >= scan.critical_rays);
            CHECK(critical > 2);
            ++scans;
        }
    }
    CHECK(scans == 59);  // the first turn asked for them
    CHECK(copied > 20);
    w.settle();
    static_cast<void>(watcher.all(w.board));
    CHECK(watcher.map.beginnings == 1);
    CHECK(watcher.map.size() == w.modules.map->map().tiles());
    CHECK(w.different(watcher) == 0);
    CHECK(watcher.map.grid().cells == export_map(w.modules.map->map(), params().map.resolution_m).cells);

    // Nothing changes: nothing is sent. One scan: only what it has changed.
    const std::size_t sent = watcher.map.sent;
    w.settle();
    CHECK(only<view::TilesEvent>(watcher.all(w.board)).empty());
    w.scan();
    w.settle();
    static_cast<void>(watcher.all(w.board));
    CHECK(watcher.map.sent > sent);
    CHECK(watcher.map.sent <= sent + watcher.map.size());
    CHECK(w.different(watcher) == 0);
}

TEST_CASE("watch feed: pictures of the map come twice a second at most") {
    WatchedDrive w;
    w.scan();
    std::uint16_t last = 0;
    int orders = 0;
    for (int i = 0; i < 500; ++i) {  // 10 s
        w.feed_turn();
        w.map_turns();
        const PictureOrder order = w.modules.exchange->picture_order.load();
        orders += order.number != last ? 1 : 0;
        last = order.number;
    }
    CHECK(orders >= 19);
    CHECK(orders <= 21);
}

TEST_CASE("watch feed: who stops and comes again gets the whole map again, meanwhile the modules do nothing for it") {
    WatchedDrive w;
    for (int i = 0; i < 20; ++i) {
        w.scan();
        w.feed_turn();
    }
    w.board.watched(false);
    CHECK(w.feed_turn());  // the map's thread is told
    CHECK_FALSE(w.feed_turn());
    w.map_turns();
    static_cast<void>(w.modules.exchange->watched.update());
    while (w.modules.exchange->picture.front() != nullptr) {
        w.modules.exchange->picture.pop();
    }
    for (int i = 0; i < 10; ++i) {
        w.scan();
        CHECK_FALSE(w.feed_turn());
    }
    CHECK_FALSE(w.modules.exchange->watched.update());
    CHECK(w.modules.exchange->picture.front() == nullptr);

    w.board.watched(true);
    Watcher second;
    w.settle();
    static_cast<void>(second.all(w.board));
    CHECK(second.map.beginnings == 1);
    CHECK(w.different(second) == 0);
}

TEST_CASE("watch feed: watched or not, the modules do the same to the bit, however slow the watching is") {
    Modules alone;
    Drive same;
    WatchedDrive w;
    Watcher watcher;
    for (int i = 0; i < 60; ++i) {
        alone.wheels(same);
        alone.scan(same.scan());
        REQUIRE(alone.filter_turn());
        while (alone.map->turn()) {
        }
        w.scan();
        if (i % 3 == 0 && i % 20 < 10) {  // the control thread comes seldom, and for a while not at all
            w.feed_turn();
        }
        REQUIRE(w.modules.filter_state().result.P_map_base == alone.filter_state().result.P_map_base);
        REQUIRE(w.modules.filter_state().result.M == alone.filter_state().result.M);
        REQUIRE(w.modules.filter_state().result.evaluations == alone.filter_state().result.evaluations);
    }
    CHECK(w.board.next(watcher.cursor).size() > 1000);  // it was watched
    std::size_t tiles = 0;
    std::size_t different = 0;
    alone.map->map().for_each_tile([&](Cell corner, const OccupancyTile& tile) {
        const OccupancyTile* const other = w.modules.map->map().find(corner);
        different += other != nullptr && other->cells == tile.cells ? 0U : 1U;
        ++tiles;
    });
    CHECK(different == 0);
    CHECK(tiles == w.modules.map->map().tiles());
}

TEST_CASE("watch feed: far tiles belong to the picture, and one that goes away unseen is not lost") {
    WatchedDrive w;
    std::size_t kept = 0;
    const auto keep = [&](std::int32_t x, std::int32_t y, Evidence evidence) {
        TileCells cells;
        cells.fill(evidence);
        w.far_tiles.keep({.x = x * TileGeometry::kSide, .y = y * TileGeometry::kSide}, cells);
        ++kept;
    };
    for (std::int32_t i = 0; i < 200; ++i) {
        keep(-400 + i % 20, i / 20, kOccupiedCell);
    }
    const auto changes = std::make_unique<ChangeList>();
    for (std::int32_t i = 0; i < 7900; ++i) {  // more than stays in memory
        TileRecord far{.cell = {.x = (200 + i % 100) * TileGeometry::kSide, .y = i / 100 * TileGeometry::kSide},
                       .cells = {}};
        far.cells.fill(kFreeCell);
        changes->clear();
        w.modules.map->load(far, *changes);
        w.modules.filter->follow(*changes);
    }
    Watcher watcher;
    for (int i = 0; i < 60; ++i) {  // tiles go faster than they are looked at
        w.scan();
        w.feed_turn();
        w.far_tiles.turn(w.modules.exchange->far_tiles);
    }
    const std::uint64_t gone = w.far_tiles.state().tiles - kept;
    CHECK(gone > 700);
    w.settle();
    static_cast<void>(watcher.all(w.board));
    CHECK(w.different(watcher) == 0);
    CHECK(watcher.map.beginnings == 1);
    CHECK(watcher.map.size() == w.modules.map->map().tiles() + w.far_tiles.state().tiles);
    CHECK(watcher.map.at({.x = -400 * TileGeometry::kSide, .y = 0})->front() == 100);

    // The room changes, and before anybody looks the robot is carried so far away that the room goes to the disk.
    const Cell room{};
    for (int i = 0; i < 5; ++i) {
        w.scan();
    }
    REQUIRE(w.modules.map->map().find(room) != nullptr);
    const double tile_m = TileGeometry::kSide * params().map.resolution_m;
    REQUIRE(w.modules.exchange->commands.push({.P_map_base = {.x_m = 250.0 * tile_m, .y_m = -20.0 * tile_m}}));
    for (int i = 0; i < 20; ++i) {
        w.scan();
        w.far_tiles.turn(w.modules.exchange->far_tiles);
    }
    CHECK(w.modules.map->map().find(room) == nullptr);
    w.settle();
    static_cast<void>(watcher.all(w.board));
    CHECK(w.different(watcher) == 0);
    CHECK(watcher.map.beginnings == 1);
}
