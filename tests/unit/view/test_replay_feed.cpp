#include "tools/view/replay_feed.hpp"

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <map>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "platform/service/map_image.hpp"
#include "tests/replay/simulated_log.hpp"
#include "tests/unit/platform/scratch.hpp"
#include "tools/crspf/pose_digest.hpp"
#include "tools/crspf/replay.hpp"

using namespace crspf;
using namespace crspf::view;

namespace {

ReplayJob office_job(const crspf::test::Scratch& scratch, double duration_s) {
    const auto run = crspf::test::simulate_office(crspf::test::LogFormat::kCarmen, duration_s);
    ReplayJob job;
    job.logs = {scratch.file("office.clf", run.log)};
    job.config = run.config;
    return job;
}

/// What a feed told.
struct Told {
    std::vector<ScanEvent> scans;
    std::vector<StatusEvent> statuses;
    std::map<std::pair<std::int32_t, std::int32_t>, TileImage> tiles;  ///< the newest of each
    int fresh = 0;
    bool tile_without_change = false;

    void take(const RunEvent& event) {
        if (const auto* const scan = std::get_if<ScanEvent>(&event)) {
            scans.push_back(*scan);
        } else if (const auto* const status = std::get_if<StatusEvent>(&event)) {
            statuses.push_back(*status);
        } else if (const auto* const changed = std::get_if<TilesEvent>(&event)) {
            fresh += changed->fresh ? 1 : 0;
            for (const TileImage& tile : changed->tiles) {
                const auto [found, is_new] = tiles.try_emplace({tile.corner.x, tile.corner.y}, tile);
                tile_without_change = tile_without_change || (!is_new && found->second.cells == tile.cells);
                found->second = tile;
            }
        }
    }
    [[nodiscard]] std::string digest() const {
        std::vector<TimedPose> trajectory;
        for (const ScanEvent& scan : scans) {
            trajectory.push_back({.stamp_s = 0.0, .P_map_base = scan.P_map_base});
        }
        return digest_of(trajectory);
    }
};

Told play(ReplayFeed& feed) {
    Told told;
    while (feed.step([&told](const RunEvent& event) { told.take(event); })) {
    }
    return told;
}

GridCell cell_of(std::uint8_t percent) {
    return percent == TileImage::kUnseen ? GridCell::kUnknown : percent >= 50 ? GridCell::kOccupied : GridCell::kFree;
}

/// Cells that are not the map's.
std::size_t differences(const GridMap& map, const Told& told) {
    std::size_t differ = 0;
    std::size_t inside = 0;
    const int low_x = static_cast<int>(std::lround(map.P_map_origin.x_m / map.resolution_m));
    const int low_y = static_cast<int>(std::lround(map.P_map_origin.y_m / map.resolution_m));
    for (const auto& [corner, tile] : told.tiles) {
        for (std::int32_t y = 0; y < TileGeometry::kSide; ++y) {
            for (std::int32_t x = 0; x < TileGeometry::kSide; ++x, ++inside) {
                const int column = corner.first + x - low_x;
                const int row = corner.second + y - low_y;
                const bool same = map.contains(column, row) &&
                                  map.at(column, row) == cell_of(tile.cells[TileGeometry::offset({.x = x, .y = y})]);
                differ += same ? 0 : 1;
            }
        }
    }
    const auto cells = static_cast<std::size_t>(map.width) * static_cast<std::size_t>(map.height);
    const auto known = static_cast<std::size_t>(
        std::count_if(map.cells.begin(), map.cells.end(), [](GridCell cell) { return cell != GridCell::kUnknown; }));
    return differ + (inside <= cells && known > 1000 ? 0 : 1);
}

}  // namespace

TEST_CASE(
    "replay feed: the poses of crspf replay, to the bit, its tiles put together are the map, again from the start") {
    const crspf::test::Scratch scratch;
    const ReplayJob job = office_job(scratch, 40.0);
    const ReplayOutcome outcome = run_replay(job);
    const GridMap map =
        export_map(outcome.pipeline->map(), outcome.config.slam.map.resolution_m, outcome.far_tiles.get());

    ReplayFeed feed(job);
    CHECK_FALSE(feed.duration_s());
    Told told = play(feed);
    CHECK(told.digest() == outcome.digest);
    CHECK(told.fresh == 1);
    CHECK_FALSE(told.tile_without_change);
    CHECK(differences(map, told) == 0);
    CHECK(feed.position_s() == Approx(40.0).margin(1.0));
    CHECK(feed.duration_s() == feed.position_s());
    CHECK(feed.share() == 1.0);

    // Points: as many as rays, and the critical ones among them.
    std::size_t critical = 0;
    for (const ScanEvent& scan : told.scans) {
        REQUIRE(scan.points.size() == scan.rays);
        const auto marked = std::count_if(scan.points.begin(), scan.points.end(),
                                          [](const ScanEvent::Point& point) { return point.critical; });
        REQUIRE(static_cast<std::size_t>(marked) == scan.critical_rays);
        critical += scan.critical_rays;
        REQUIRE(scan.range_m >= 0.0);
    }
    CHECK(critical > told.scans.size());
    CHECK(told.scans.back().range_m > 0.0);
    CHECK(told.scans.back().range_rad > 0.0);
    CHECK(told.scans.back().thresholds.result_on == outcome.config.slam.analyser.result_on);
    CHECK(std::is_sorted(told.scans.begin(), told.scans.end(),
                         [](const ScanEvent& a, const ScanEvent& b) { return a.stamp_ns < b.stamp_ns; }));
    // Once a second and at the end.
    CHECK(told.statuses.size() >= 40);
    CHECK(told.statuses.size() <= 43);
    CHECK(told.statuses.back().status["filter"]["scans"] == told.scans.size());
    CHECK_FALSE(feed.step([](const RunEvent& /*event*/) { FAIL("the end is told once"); }));

    feed.restart();
    CHECK(feed.position_s() == 0.0);
    CHECK(feed.duration_s());
    told = play(feed);
    CHECK(told.digest() == outcome.digest);
    CHECK(told.fresh == 1);
    // Control: one cell that is another is found.
    TileImage& tile = told.tiles.begin()->second;
    tile.cells[0] = tile.cells[0] == TileImage::kUnseen ? 0 : TileImage::kUnseen;
    CHECK(differences(map, told) == 1);
}

TEST_CASE("replay feed: stamps are the recording's, however they leap") {
    const crspf::test::Scratch scratch;
    ReplayJob job = office_job(scratch, 3.0);
    ReplayFeed feed(job);
    const Told told = play(feed);
    const ReplayOutcome outcome = run_replay(job);
    REQUIRE(told.scans.size() == outcome.trajectory.size());
    for (std::size_t i = 0; i < told.scans.size(); ++i) {
        REQUIRE(1e-9 * static_cast<double>(told.scans[i].stamp_ns) ==
                Approx(outcome.trajectory[i].stamp_s).margin(1e-6));
    }
}

TEST_CASE("replay feed: what holds no scan says so") {
    const crspf::test::Scratch scratch;
    ReplayJob job;
    job.logs = {scratch.file("empty.clf", "# nothing\nODOM 0 0 0 0 0 0 1 host 1\n")};
    ReplayFeed feed(job);
    CHECK_THROWS_WITH(feed.step([](const RunEvent& /*event*/) {}), Catch::Contains("no usable scan"));
}

TEST_CASE("replay feed: tiles that went far away are shown as they were") {
    const auto map = std::make_unique<OccupancyMap>();
    const crspf::test::Scratch scratch;
    TileArchive far(scratch.directory());
    ChangedTiles changed(0.05);
    map->touch({.x = 0, .y = 0})->cells.fill(kFreeCell);
    CHECK(changed.look(*map, nullptr).tiles.size() == 1);
    CHECK(changed.look(*map, nullptr).tiles.empty());
    // It changes, goes away, and a part of it is seen anew before it comes back.
    TileCells gone = map->find({.x = 0, .y = 0})->cells;
    gone[1] = kOccupiedCell;
    far.keep({.x = 0, .y = 0}, gone);
    map->release({.x = 0, .y = 0});
    CHECK(changed.look(*map, nullptr).tiles.empty());
    map->touch({.x = 0, .y = 0})->cells[2] = kOccupiedCell;
    const TilesEvent event = changed.look(*map, &far);
    REQUIRE(event.tiles.size() == 1);
    CHECK_FALSE(event.fresh);
    CHECK(event.tiles[0].cells[0] == 0);
    CHECK(event.tiles[0].cells[1] == 100);
    CHECK(event.tiles[0].cells[2] == 100);
}
