// What watchers are sent: each what he has not had, bounded however slow he is.
#include <catch2/catch.hpp>
#include <memory>
#include <string>
#include <vector>

#include "tests/support/heap_guard.hpp"
#include "tests/support/resident.hpp"
#include "tests/unit/crspfd/watched_map.hpp"

using namespace crspf;
using namespace crspf::test;

namespace {

constexpr Duration kUtc{1'700'000'000'000'000'000};

std::unique_ptr<WatchedScan> scan_of(int number, std::uint32_t points = 500) {
    auto scan = std::make_unique<WatchedScan>();
    scan->result.stamp = Stamp{1000 + number};
    scan->result.P_map_base = {.x_m = 0.1 * number, .y_m = -1.0 / 3.0, .theta_rad = 0.25};
    scan->result.shape.covariance = {.xx = 1e-4, .xy = 2e-5, .yy = 3e-4, .xt = 4e-6, .yt = 5e-6, .tt = 1e-5};
    scan->result.shape.degenerate = true;
    scan->result.M = 1234.5 + number;
    scan->result.m = 1200.25;
    scan->result.matched = scan->result.result = true;
    scan->result.rays = points;
    scan->result.critical_rays = points / 2;
    scan->result.evaluations = 321;
    scan->result.range_m = 0.125;
    scan->result.range_rad = 0.0625;
    scan->P_map_odom = {.x_m = 1.0 / 7.0, .y_m = 0.0, .theta_rad = -0.5};
    scan->count = points;
    for (std::uint32_t i = 0; i < points; ++i) {
        scan->x_m[i] = 0.01F * static_cast<float>(i);
        scan->y_m[i] = -1.0F / 3.0F;
        scan->critical[i] = i % 2 == 1;
    }
    return scan;
}

TileCells cells_of(Evidence evidence) {
    TileCells cells;
    cells.fill(evidence);
    return cells;
}

Cell corner_of(std::int32_t number) {
    return {.x = (number % 50 - 25) * TileGeometry::kSide, .y = number / 50 * TileGeometry::kSide};
}

class Watched {
 public:
    Watched() { board.watched(true); }
    void scan(int number) { board.take_scan(*scan_of(number), kUtc, {}); }

    WatchBoard board;
};

}  // namespace

TEST_CASE("watch board: a scan arrives as it was, to the bit, once to each watcher") {
    Watched w;
    w.scan(1);
    for (int i = 0; i < 2; ++i) {
        Watcher watcher;
        const std::vector<view::RunEvent> events = watcher.all(w.board);
        REQUIRE(events.size() == 1);
        const auto& scan = std::get<view::ScanEvent>(events[0]);
        const auto given = scan_of(1);
        CHECK(scan.stamp_ns == kUtc.ns + 1001);
        CHECK(scan.P_map_base == given->result.P_map_base);
        CHECK(scan.P_map_odom == given->P_map_odom);
        CHECK(scan.covariance == given->result.shape.covariance);
        CHECK(scan.M == 1235.5);
        CHECK(scan.m == 1200.25);
        CHECK(scan.thresholds.result_on == AnalyserParams{}.result_on);
        CHECK(scan.thresholds.draw_off == AnalyserParams{}.draw_off);
        CHECK(scan.matched);
        CHECK(scan.result);
        CHECK_FALSE(scan.draw);
        CHECK_FALSE(scan.lost);
        CHECK(scan.degenerate);
        CHECK(scan.rays == 500);
        CHECK(scan.critical_rays == 250);
        CHECK(scan.evaluations == 321);
        CHECK(scan.range_m == 0.125);
        CHECK(scan.range_rad == 0.0625);
        REQUIRE(scan.points.size() == 500);
        CHECK(scan.points[7].x_m == given->x_m[7]);
        CHECK(scan.points[7].y_m == given->y_m[7]);
        CHECK(scan.points[7].critical);
        CHECK_FALSE(scan.points[8].critical);
        CHECK(watcher.all(w.board).empty());
    }
    Watcher late;
    w.scan(2);
    w.scan(3);  // the newest wins
    const std::vector<view::RunEvent> events = late.all(w.board);
    REQUIRE(events.size() == 1);
    CHECK(std::get<view::ScanEvent>(events[0]).M == 1237.5);
}

TEST_CASE("watch board: where nobody watches nothing is kept but the log") {
    WatchBoard board;
    board.take_scan(*scan_of(1), kUtc, {});
    board.take_status(1, {{"version", 1}});
    board.begin_map(0.02);
    board.take_tile({}, cells_of(kFreeCell));
    board.take_log(5, WatchBoard::Level::kWarning, "source lidar: stale");
    Watcher watcher;
    std::vector<view::RunEvent> events = watcher.all(board);
    REQUIRE(events.size() == 1);
    CHECK(std::get<view::LogLine>(events[0]).text == "source lidar: stale");
    CHECK(std::get<view::LogLine>(events[0]).level == view::LogLine::Level::kWarning);
    CHECK(std::get<view::LogLine>(events[0]).stamp_ns == 5);

    board.watched(true);
    board.take_scan(*scan_of(1), kUtc, {});
    board.take_status(1, {{"version", 1}});
    board.begin_map(0.02);
    board.take_tile({}, cells_of(kFreeCell));
    board.watched(false);
    CHECK(watcher.all(board).empty());
    board.watched(true);
    CHECK(watcher.all(board).empty());
}

TEST_CASE("watch board: tiles come whole at first, then as they change, a few at a time") {
    Watched w;
    Watcher watcher;
    CHECK(watcher.all(w.board).empty());
    w.board.begin_map(0.025);
    std::vector<view::TilesEvent> events = only<view::TilesEvent>(watcher.all(w.board));
    REQUIRE(events.size() == 1);  // an empty map is one, too
    CHECK(events[0].fresh);
    CHECK(events[0].tiles.empty());
    CHECK(events[0].resolution_m == 0.025);

    for (std::int32_t i = 0; i < 100; ++i) {
        w.board.take_tile(corner_of(i), cells_of(kOccupiedFrom));
    }
    events = only<view::TilesEvent>(watcher.all(w.board));
    REQUIRE(events.size() == 7);
    for (const view::TilesEvent& event : events) {
        CHECK_FALSE(event.fresh);
        CHECK(event.tiles.size() <= WatchBoard::kTilesALine);
    }
    CHECK(watcher.map.size() == 100);
    REQUIRE(watcher.map.at(corner_of(42)) != nullptr);
    CHECK(watcher.map.at(corner_of(42))->front() == 50);

    // What is the same as before is no news; what a tile has not seen stays what it was.
    TileCells cells = cells_of(kUnseen);
    w.board.take_tile(corner_of(3), cells);
    w.board.take_tile(corner_of(4), cells_of(kOccupiedFrom));
    CHECK(watcher.all(w.board).empty());
    cells[9] = kOccupiedCell;
    w.board.take_tile(corner_of(3), cells);
    events = only<view::TilesEvent>(watcher.all(w.board));
    REQUIRE(events.size() == 1);
    REQUIRE(events[0].tiles.size() == 1);
    CHECK(events[0].tiles[0].corner == corner_of(3));
    CHECK(events[0].tiles[0].cells[8] == 50);
    CHECK(events[0].tiles[0].cells[9] == 100);

    // A tile that changes again and again is sent once to who comes late, as it is then.
    Watcher late;
    for (int i = 0; i < 1000; ++i) {
        w.board.take_tile(corner_of(5), cells_of(i % 2 == 0 ? kFreeCell : kOccupiedCell));
    }
    events = only<view::TilesEvent>(late.all(w.board));
    CHECK(events.front().fresh);
    CHECK(late.map.sent == 100);
    CHECK(late.map.at(corner_of(5))->front() == 100);

    // Another map.
    w.board.begin_map(0.05);
    w.board.take_tile({}, cells_of(kFreeCell));
    CHECK(watcher.all(w.board).size() == 1);
    CHECK(watcher.map.beginnings == 2);
    CHECK(watcher.map.size() == 1);
    CHECK(watcher.map.at({})->front() == 0);
}

TEST_CASE("watch board: of the log a newcomer gets the last lines, each cut to what fits") {
    Watched w;
    for (std::size_t i = 0; i < 3 * WatchBoard::kLogLines; ++i) {
        w.board.take_log(0, WatchBoard::Level::kInfo, "line " + std::to_string(i));
    }
    Watcher watcher;
    std::vector<view::LogLine> lines = only<view::LogLine>(watcher.all(w.board));
    REQUIRE(lines.size() == WatchBoard::kLogLines);
    CHECK(lines.front().text == "line 400");
    CHECK(lines.back().text == "line 599");
    w.board.take_log(0, WatchBoard::Level::kError, std::string(100'000, 'x') + "\xFF");
    w.board.take_log(0, WatchBoard::Level::kDebug, "not UTF-8: \xFF\xFE");
    lines = only<view::LogLine>(watcher.all(w.board));
    REQUIRE(lines.size() == 2);
    CHECK(lines[0].text.size() == WatchBoard::kLogTextMax);
    CHECK(lines[1].text.find("not UTF-8") == 0);
}

TEST_CASE("watch board: none of the four kinds waits for another for ever") {
    Watched w;
    w.board.begin_map(0.02);
    Watcher watcher;
    std::size_t scans = 0;
    std::size_t statuses = 0;
    std::size_t logs = 0;
    std::size_t tiles = 0;
    for (int i = 0; i < 400; ++i) {  // all four are new each time that he can take a line
        w.scan(i);
        w.board.take_status(i, {{"number", i}});
        w.board.take_log(i, WatchBoard::Level::kInfo, "line");
        w.board.take_tile(corner_of(i), cells_of(kFreeCell));
        const std::optional<view::RunEvent> event = watcher.next(w.board);
        REQUIRE(event);
        scans += std::holds_alternative<view::ScanEvent>(*event) ? 1U : 0U;
        statuses += std::holds_alternative<view::StatusEvent>(*event) ? 1U : 0U;
        logs += std::holds_alternative<view::LogLine>(*event) ? 1U : 0U;
        tiles += std::holds_alternative<view::TilesEvent>(*event) ? 1U : 0U;
    }
    CHECK(scans == 100);
    CHECK(statuses == 100);
    CHECK(logs == 100);
    CHECK(tiles == 100);
}

TEST_CASE("watch board: slow watchers cost no memory") {
    if (!HeapGuard::available() || resident_mib() == 0.0) {
        WARN("skipped: a sanitizer keeps what is freed, or /proc does not say");
        return;
    }
    Watched w;
    w.board.begin_map(0.02);
    std::vector<Watcher> slow(20);
    std::size_t had = 0;
    const auto run = [&](int events, std::vector<std::string>* kept) {
        for (int i = 0; i < events; ++i) {
            w.scan(i);
            w.board.take_status(i, {{"number", i}});
            w.board.take_log(i, WatchBoard::Level::kInfo, "line");
            w.board.take_tile(corner_of(i % 500), cells_of(i / 500 % 2 == 0 ? kFreeCell : kOccupiedCell));
            if (i % 5 != 0) {
                continue;  // each takes one line in a hundred events
            }
            std::string line = w.board.next(slow[static_cast<std::size_t>(i / 5 % 20)].cursor);
            had += line.empty() ? 0U : 1U;
            if (kept != nullptr) {
                kept->push_back(std::move(line));
            }
        }
    };
    run(1000, nullptr);
    const double before_mib = resident_mib();
    run(4000, nullptr);
    CHECK(resident_mib() - before_mib < 2.0);
    CHECK(had == 1000);

    std::vector<std::string> kept;  // control: it would be seen
    run(4000, &kept);
    CHECK(resident_mib() - before_mib > 4.0);
}
