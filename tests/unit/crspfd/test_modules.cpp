// The service's modules, called by one thread in whatever order: with the same samples they do what Pipeline does, and
// a slow one holds nobody up.
#include <catch2/catch.hpp>
#include <initializer_list>
#include <memory>

#include "core/slam/pipeline.hpp"
#include "platform/service/tile_archive.hpp"
#include "tests/unit/crspfd/drive.hpp"
#include "tests/unit/platform/scratch.hpp"
#include "tools/crspf/run_player.hpp"

using namespace crspf;
using namespace crspf::test;

namespace {

bool same_pose(const Pose2& a, const Pose2& b, double tolerance) {
    return std::abs(a.x_m - b.x_m) < tolerance && std::abs(a.y_m - b.y_m) < tolerance &&
           std::abs(wrap_angle(a.theta_rad - b.theta_rad)) < tolerance;
}

/// Up to the next scan: the wheels' samples, for all alike.
void roll(Drive& drive, Modules& modules, std::initializer_list<Pipeline*> pipelines) {
    for (const DifferentialSample& sample : drive.wheels()) {
        modules.now = sample.stamp;
        REQUIRE(modules.exchange->motions.push({.sample = sample, .received = sample.stamp}));
        modules.odometry->turn(sample.stamp);
        for (Pipeline* const pipeline : pipelines) {
            pipeline->on_wheel(sample);
        }
    }
}

}  // namespace

TEST_CASE("modules: called one after the other they give the pipeline's poses, to the bit") {
    const auto pipeline = std::make_unique<Pipeline>(params());
    Modules modules;
    Drive drive;
    Drive same;
    for (int i = 0; i < 60; ++i) {
        for (const DifferentialSample& sample : same.wheels()) {
            pipeline->on_wheel(sample);
        }
        const ScanResult expected = pipeline->on_scan(same.scan());

        modules.wheels(drive);
        modules.scan(drive.scan());
        REQUIRE(modules.filter_turn());
        REQUIRE(modules.map->turn());
        const ScanResult& result = modules.filter_state().result;
        REQUIRE(result.P_map_base == expected.P_map_base);
        REQUIRE(result.M == expected.M);

        // The odometry's thread takes the correction with its next turn, and is where the filter is.
        modules.odometry->turn(modules.now);
        const OdometryState& odometry = modules.odometry_state();
        REQUIRE(same_pose(odometry.P_map_odom * odometry.P_odom_base, pipeline->odometry().pose(), 1e-9));
        REQUIRE(odometry.speed_mps == Approx(1.02 * kDriveSpeed_mps).epsilon(0.01));
    }
    std::size_t different = 0;
    std::size_t cells = 0;
    pipeline->map().for_each_tile([&](Cell corner, const OccupancyTile& tile) {
        for (std::int32_t i = 0; i < TileGeometry::kSide * TileGeometry::kSide; ++i) {
            const Cell cell{.x = corner.x + i % TileGeometry::kSide, .y = corner.y + i / TileGeometry::kSide};
            different += modules.map->map().at(cell) == tile.cells[TileGeometry::offset(cell)] ? 0U : 1U;
            ++cells;
        }
    });
    CHECK(different == 0);
    CHECK(cells > 10000);
}

TEST_CASE("modules: a map update that hangs holds up no pose, and is counted") {
    Modules modules;
    Drive drive;
    for (int i = 0; i < 20; ++i) {
        modules.wheels(drive);
        modules.scan(drive.scan());
        REQUIRE(modules.filter_turn());
        if (i < 5) {
            modules.map->turn();
        }
    }
    CHECK(modules.filter_state().counters.scans == 20);
    CHECK(modules.filter_state().result.matched);
    CHECK(modules.filter_state().undrawn == 11);  // four waited
    // It comes back: what waited is drawn, and the filter's image of the map is complete.
    while (modules.map->turn()) {
    }
    for (int i = 0; i < 10; ++i) {
        modules.wheels(drive);
        modules.scan(drive.scan());
        REQUIRE(modules.filter_turn());
        while (modules.map->turn()) {
        }
    }
    CHECK(modules.filter_state().undrawn == 11);
    CHECK(modules.filter_state().result.result);
}

TEST_CASE("modules: the newest scan wins, and the others are counted") {
    Modules modules;
    Drive drive;
    CHECK_FALSE(modules.filter_turn());
    for (int i = 0; i < 3; ++i) {
        modules.wheels(drive);
        modules.scan(drive.scan());
    }
    const Stamp newest = drive.scan().stamp;
    REQUIRE(modules.filter_turn());
    CHECK(modules.filter_state().result.stamp == newest);
    CHECK(modules.filter_state().skipped_scans == 2);
    CHECK_FALSE(modules.filter_turn());
}

TEST_CASE(
    "modules: revolutions in place of scans, levelled and matched in the filter's thread, to the pipeline's bits") {
    Modules modules;
    modules.exchange->cloud = std::make_unique<LatestValue<ReceivedCloud>>();
    modules.exchange->recording = true;
    const auto pipeline = std::make_unique<Pipeline>(params());
    Drive drive;
    const double height_m = params().obstacles.lidar_height_m;
    const auto publish = [&](const Cloud& cloud) {
        modules.exchange->cloud->slot().cloud.take(cloud);
        modules.exchange->cloud->slot().received = modules.now;
        modules.exchange->cloud->publish();
    };
    for (int i = 0; i < 40; ++i) {
        roll(drive, modules, {pipeline.get()});
        const auto cloud = cloud_of(drive.scan(), height_m);
        publish(*cloud);
        const std::optional<ScanResult> expected = pipeline->on_cloud(*cloud);
        REQUIRE(modules.filter_turn());
        REQUIRE(modules.map->turn());
        REQUIRE(expected);
        REQUIRE(modules.filter_state().result.P_map_base == expected->P_map_base);
        JournalEntry entry;
        REQUIRE(modules.exchange->journal.pop(entry));
        REQUIRE(entry.scan == static_cast<std::uint64_t>(i + 1));
    }
    CHECK(modules.filter_state().result.result);
    CHECK(modules.filter_state().result.rays > 300);

    auto broken = cloud_of(drive.scan(), height_m);
    broken->complete = false;
    publish(*broken);
    CHECK_FALSE(modules.filter_turn());
    publish(*broken);
    publish(*cloud_of(drive.scan(), height_m));
    CHECK(modules.filter_turn());
    CHECK(modules.filter_state().skipped_scans == 1);
}

TEST_CASE("modules: a filter that hangs holds up no odometry") {
    Modules modules;
    Drive drive;
    for (int i = 0; i < 10; ++i) {
        modules.wheels(drive);
    }
    const OdometryState& odometry = modules.odometry_state();
    CHECK(odometry.stamp == drive.now());
    CHECK(odometry.P_odom_base.x_m > 0.3);
}

TEST_CASE("modules: another process's motion moves odometry and filter alike, and it is known since when it is blind") {
    Modules modules;
    const auto hear = [&](int number, bool blind) {
        modules.now = stamp_of(0.05 * number);
        const MotionSample sample{.stamp = modules.now, .P_previous_base = {.x_m = 0.1}, .blind = blind};
        REQUIRE(modules.exchange->motions.push({.sample = sample, .received = modules.now}));
        CHECK(modules.odometry->turn(modules.now));
    };
    for (int i = 1; i <= 4; ++i) {
        hear(i, false);
    }
    CHECK(modules.odometry_state().P_odom_base.x_m == Approx(0.4));
    CHECK(modules.odometry_state().blind_since == Stamp{});
    hear(5, true);
    hear(6, true);
    CHECK(modules.odometry_state().blind_since == stamp_of(0.25));
    CHECK(modules.odometry_state().P_odom_base.x_m == Approx(0.6));
    hear(7, false);
    CHECK(modules.odometry_state().blind_since == Stamp{});

    Drive drive;
    Scan scan = drive.scan();
    scan.stamp = modules.now;
    modules.scan(scan);
    REQUIRE(modules.filter_turn());
    CHECK(modules.filter_state().result.P_map_observed.x_m == Approx(0.7));
}

TEST_CASE("modules: an operator's pose reaches filter and odometry, and is a jump") {
    Modules modules;
    Drive drive;
    const Pose2 placed{.x_m = 10.0, .y_m = -5.0, .theta_rad = 1.0};
    modules.wheels(drive);
    REQUIRE(modules.exchange->commands.push({.P_map_base = placed}));
    CHECK_FALSE(modules.filter_turn());
    modules.odometry->turn(modules.now);
    const OdometryState& odometry = modules.odometry_state();
    CHECK(same_pose(odometry.P_map_odom * odometry.P_odom_base, placed, 1e-9));
    CHECK(odometry.jumps == 1);
    modules.scan(drive.scan());
    REQUIRE(modules.filter_turn());
    CHECK(same_pose(modules.filter_state().result.P_map_base, placed, 0.1));
}

TEST_CASE("modules: a place found for an earlier scan gets what the robot has moved since") {
    Modules modules;
    Drive drive;
    const Pose2 found{.x_m = 3.0, .y_m = 2.0, .theta_rad = -1.0};
    modules.exchange->scans_wanted = true;
    modules.wheels(drive);
    modules.scan(drive.scan());
    REQUIRE(modules.filter_turn());
    REQUIRE(modules.exchange->seen.update());
    const SeenScan& seen = modules.exchange->seen.value();
    CHECK(seen.points.count > 300);
    modules.exchange->scans_wanted = false;
    const Pose2 P_odom_before = modules.odometry_state().P_odom_base;

    for (int i = 0; i < 5; ++i) {
        modules.wheels(drive);
    }
    const Pose2 moved = inverse(P_odom_before) * modules.odometry_state().P_odom_base;
    REQUIRE(modules.exchange->commands.push({.P_map_base = found, .P_odom_base = seen.P_odom_base}));
    CHECK_FALSE(modules.filter_turn());
    CHECK_FALSE(modules.exchange->seen.update());  // no longer wanted
    modules.odometry->turn(modules.now);
    const OdometryState& odometry = modules.odometry_state();
    CHECK(odometry.jumps == 1);
    CHECK(same_pose(odometry.P_map_odom * odometry.P_odom_base, found * moved, 1e-6));
}

TEST_CASE("modules: the map can be had whole while it is drawn") {
    Modules modules;
    Drive drive;
    for (int i = 0; i < 10; ++i) {
        modules.wheels(drive);
        modules.scan(drive.scan());
        modules.filter_turn();
        while (modules.map->turn()) {
        }
    }
    modules.exchange->copies_wanted.fetch_add(1);
    std::size_t tiles = 0;
    bool last = false;
    for (int turns = 0; turns < 1000 && !last; ++turns) {
        modules.map->turn();
        while (const TileCopy* const copy = modules.exchange->tiles.front()) {
            CHECK(copy->tile.cells == modules.map->map().tile(tiles).cells);
            ++tiles;
            last = copy->last;
            modules.exchange->tiles.pop();
        }
    }
    CHECK(last);
    CHECK(tiles == modules.map->map().tiles());
    CHECK(tiles > 3);

    SECTION("an empty one, too") {
        Modules fresh;
        fresh.exchange->copies_wanted.fetch_add(1);
        fresh.map->turn();
        const TileCopy* const copy = fresh.exchange->tiles.front();
        REQUIRE(copy != nullptr);
        CHECK(copy->empty);
        CHECK(copy->last);
    }
}

TEST_CASE("modules: whatever the timing was, the pipeline finds the same poses from the journal, otherwise others") {
    Modules modules;
    modules.exchange->recording = true;
    const auto same = std::make_unique<Pipeline>(params());
    const auto other = std::make_unique<Pipeline>(params());
    Drive drive;
    std::size_t differ = 0;
    std::uint64_t scans = 0;
    for (int i = 0; i < 60; ++i) {
        roll(drive, modules, {same.get(), other.get()});
        modules.scan(drive.scan());
        if (i % 7 == 3) {
            continue;  // the filter comes too late: this scan is skipped
        }
        REQUIRE(modules.filter_turn());
        if (i % 9 > 5) {  // the map's thread is busy elsewhere, then catches up
            while (modules.map->turn()) {
            }
        }
        JournalEntry entry;
        REQUIRE(modules.exchange->journal.pop(entry));
        CHECK(entry.scan == static_cast<std::uint64_t>(i + 1));
        CHECK(entry.motions == static_cast<std::uint64_t>(10 * (i + 1)));
        const ScanResult replayed = same->on_scan(drive.scan(), timing_of(entry));
        REQUIRE(replayed.P_map_base == entry.P_map_base);
        differ += other->on_scan(drive.scan()).P_map_base == entry.P_map_base ? 0U : 1U;
        ++scans;
    }
    CHECK(scans > 45);
    CHECK(differ > 20);  // it is the timing that makes the difference
    CHECK(modules.filter_state().undrawn > 0);
}

TEST_CASE("modules: far tiles come and go whenever the disk allows, and the journal brings the same poses back") {
    // A robot in a map larger than the pool, whose own room is on the disk at the start.
    const auto mapper = std::make_unique<Pipeline>(params());
    Drive before;
    for (int i = 0; i < 40; ++i) {
        for (const DifferentialSample& sample : before.wheels()) {
            mapper->on_wheel(sample);
        }
        mapper->on_scan(before.scan());
    }
    Modules modules;
    modules.exchange->recording = true;
    const Scratch scratch;
    TileArchive live_disk(scratch.directory());
    TileArchive replay_disk(scratch.directory());
    const auto same = std::make_unique<Pipeline>(params());
    const auto other = std::make_unique<Pipeline>(params());
    TileRings& replay_rings = same->add_tile_keeper();
    mapper->map().for_each_tile([&](Cell corner, const OccupancyTile& tile) {
        live_disk.keep(corner, tile.cells);
        replay_disk.keep(corner, tile.cells);
    });
    const auto changes = std::make_unique<ChangeList>();
    for (std::int32_t i = 0; i < 7900; ++i) {
        TileRecord far{.cell = {.x = (200 + i % 100) * TileGeometry::kSide, .y = i / 100 * TileGeometry::kSide},
                       .cells = {}};
        far.cells.fill(kFreeCell);
        changes->clear();
        modules.map->load(far, *changes);
        modules.filter->follow(*changes);
        same->load(far);
        other->load(far);
    }
    Drive drive;
    std::size_t differ = 0;
    for (int i = 0; i < 80; ++i) {
        roll(drive, modules, {same.get(), other.get()});
        modules.scan(drive.scan());
        REQUIRE(modules.filter_turn());
        if (i % 5 > 1) {  // the map's thread and the disk are late, each in its own way
            while (modules.map->turn()) {
            }
        }
        if (i % 11 > 6) {
            live_disk.turn(modules.exchange->far_tiles);
        }
        JournalEntry entry;
        REQUIRE(modules.exchange->journal.pop(entry));
        const ScanResult replayed = same->on_scan(drive.scan(), timing_of(entry));
        replay_disk.turn(replay_rings);
        REQUIRE(replayed.P_map_base == entry.P_map_base);
        differ += other->on_scan(drive.scan(), {.changes = entry.changes, .update = entry.updated}).P_map_base ==
                          entry.P_map_base
                      ? 0U
                      : 1U;
    }
    CHECK(differ > 20);  // it matters when the room comes back
    CHECK(live_disk.state().brought_back >= mapper->map().tiles());
    CHECK(live_disk.state().tiles > mapper->map().tiles() + 100);
    CHECK(modules.map->map().refused() == 0);
}
