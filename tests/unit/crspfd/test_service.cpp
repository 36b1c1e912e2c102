// The whole service on simulated sensors in real time: a lidar on a pty, wheels on a bus, the pose read back from
// another bus.
#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "drivers/can/pose_frames.hpp"
#include "platform/crspfd/service.hpp"
#include "platform/files/input_error.hpp"
#include "platform/linux/monotonic_clock.hpp"
#include "platform/linux/socketcan.hpp"
#include "tests/support/live_robot.hpp"
#include "tests/support/service_bench.hpp"
#include "tests/unit/platform/scratch.hpp"
#include "tools/crspf/replay.hpp"
#include "tools/crspf/top_screen.hpp"

using namespace crspf;
using crspf::test::Scratch;
using Bench = crspf::test::ServiceBench;

TEST_CASE("service: from sensors to the pose on the bus, through an unplugging, a restart and all", "[real-kernel]") {
    const Scratch scratch;
    Pose2 left_at;
    {
        Bench bench(scratch.directory());
        bench.service->start();
        REQUIRE(bench.run_until([&] { return bench.pose_known(); }));
        CHECK(bench.service->alive());

        // It drives, and the poses follow, one after the other.
        REQUIRE(bench.run_until(
            [&] { return std::hypot(bench.last_pose->P_map_base.x_m, bench.last_pose->P_map_base.y_m) > 0.3; }));
        CHECK_FALSE(bench.last_pose->lost);
        CHECK(bench.last_pose->speed_mps == Approx(crspf::test::kSpeed_mps).margin(0.05));
        CHECK(bench.last_pose->yaw_rate_radps == Approx(crspf::test::kTurn_radps).margin(0.1));
        CHECK(bench.last_pose->resets == 0);
        CHECK(bench.decoder.counters().bad_crc + bench.decoder.counters().incomplete == 0);

        nlohmann::ordered_json status = bench.service->status();
        INFO(status.dump(1));
        CHECK(status["filter"]["scans"].get<int>() > 5);
        CHECK(status["map"]["drawn"].get<int>() > 5);
        CHECK(status["odometry"]["samples"].get<int>() > 50);
        CHECK(status["output"]["unsent"] == 0);
        CHECK(status["threads"].size() == 6);
        for (const auto& thread : status["threads"]) {
            std::uint64_t below_us = 0;
            for (const auto& step : thread["histogram_us"]) {
                CHECK(step[0] >= below_us);
                CHECK(step[1] > step[0]);
                CHECK(step[2] > 0);
                below_us = step[1];
            }
            CHECK(below_us >= thread["p999_below_us"]);
            CHECK(below_us > 0);
        }
        CHECK(status["sources"][1]["state"] == "ok");

        // As `crspf top` shows it, against a look before.
        nlohmann::ordered_json before = status;
        REQUIRE(bench.run_for(1.0));
        std::string screen;
        for (const std::string& line : cli::top_screen(bench.service->status(), before, 90)) {
            CHECK(line.size() <= 90);
            screen += line + "\n";
        }
        INFO(screen);
        CHECK(screen.find("rx-lidar") != std::string::npos);
        CHECK(screen.find("result on 700 off 500") != std::string::npos);
        CHECK(screen.find("##") != std::string::npos);
        const std::size_t rate = screen.find(" scans/s");
        REQUIRE(rate != std::string::npos);
        CHECK(std::stod(screen.substr(rate - 5, 5)) == Approx(10.0).margin(2.5));
        for (const std::string& line : cli::top_screen(bench.service->status(), nullptr, 90)) {
            CHECK(line.find("nan") == std::string::npos);
        }

        // Unplugged: the odometry carries on, then the pose is not valid any longer; and it comes back.
        bench.urg.unplug();
        REQUIRE(bench.run_until([&] { return bench.last_pose->lost; }));
        CHECK(bench.log.find("source lidar: stale") != std::string::npos);
        CHECK(bench.log.find("the pose is lost") != std::string::npos);
        bench.urg.plug_in();
        REQUIRE(bench.run_until([&] { return !bench.last_pose->lost; }));
        CHECK(bench.log.find("source lidar: ok") != std::string::npos);
        CHECK(bench.service->alive());

        const std::filesystem::path yaml = bench.service->save_map();
        CHECK(read_grid_map(yaml).width > 100);
        bench.service->stop();
        left_at = bench.last_pose->P_map_base;
    }
    // What was recorded, played again: the same poses, whatever the threads' timing was.
    std::vector<std::filesystem::path> files;
    for (const auto& entry : std::filesystem::directory_iterator(scratch / "runs")) {
        files.push_back(entry.path());
    }
    REQUIRE(files.size() == 1);
    ReplayJob job;
    job.logs = files;
    const ReplayOutcome replay = run_replay(job);
    CHECK(replay.live_same > 15);
    CHECK(replay.live_other == 0);
    CHECK(replay.live_same == replay.trajectory.size());
    std::filesystem::remove_all(scratch / "runs");

    // Restarted: it knows the map, and begins where it was left (the robot of the test has begun anew, elsewhere).
    Bench bench(scratch.directory());
    std::optional<Pose2> begun_at;  // soon it is lost there, and found
    bench.on_pose = [&](const PoseReport& pose) { begun_at = begun_at.value_or(pose.P_map_base); };
    CHECK(bench.service->status()["map"]["tiles"] > 10);
    bench.service->start();
    REQUIRE(bench.run_until([&] { return begun_at.has_value(); }));
    CHECK(std::hypot(begun_at->x_m - left_at.x_m, begun_at->y_m - left_at.y_m) < 0.5);
    // Told something wrong, it is lost, and found in the map.
    REQUIRE(bench.service->set_pose({.x_m = -1.0, .y_m = 1.5, .theta_rad = -2.0}));
    REQUIRE(bench.run_until([&] { return bench.last_pose->resets > 0; }));
    const auto is_there = [&bench] {
        const Pose2 there = crspf::test::pose_at((monotonic_now() - bench.begun).seconds());
        const Pose2& P = bench.last_pose->P_map_base;
        return !bench.last_pose->lost && bench.last_pose->result &&
               std::hypot(P.x_m - there.x_m, P.y_m - there.y_m) < 0.25;
    };
    const bool found = bench.run_until(is_there);
    INFO(bench.log);
    INFO(bench.service->pose().dump());
    CHECK(found);
    CHECK(bench.log.find("the robot was looked for in the map: found at") != std::string::npos);
    bench.service->stop();
}

TEST_CASE("service: scans that come all at once, and a line that loses half of what is said", "[real-kernel]") {
    const Scratch scratch;
    Bench bench(scratch.directory());
    bench.service->start();
    REQUIRE(bench.run_until([&] { return bench.pose_known(); }));
    const auto status = [&bench](const char* part, const char* key) {
        const nlohmann::ordered_json all = bench.service->status()[part];
        return (all.is_array() ? all[1] : all)[key].get<std::uint64_t>();  // the second source is the lidar
    };
    // A reply that arrives in part, one that does not arrive: which of them it is, chance decides.
    const auto troubles = [&bench] {
        const nlohmann::ordered_json counts = bench.service->status()["sources"][1]["counts"];
        std::uint64_t sum = 0;
        for (const char* const key : {"bad_sum", "bad_shape", "bytes_dropped", "silences", "timeouts"}) {
            sum += counts[key].get<std::uint64_t>();
        }
        return sum;
    };

    // Ten scans at once, a second long: all are accounted for, and most give way to a newer one.
    const auto heard = [&] { return status("sources", "samples"); };
    const std::uint64_t heard_before = heard();
    const std::uint64_t matched_before = status("filter", "scans");
    const std::uint64_t skipped_before = status("filter", "skipped");
    bench.scans_at_once = 10;
    REQUIRE(bench.run_for(1.0));
    bench.scans_at_once = 1;
    REQUIRE(bench.run_for(0.2));
    INFO(bench.service->status().dump(1));
    const std::uint64_t came = heard() - heard_before;
    const std::uint64_t matched = status("filter", "scans") - matched_before;
    const std::uint64_t skipped = status("filter", "skipped") - skipped_before;
    CHECK(came >= 70);
    CHECK(matched + skipped <= came);
    CHECK(matched + skipped + 1 >= came);  // one may be on its way
    CHECK(matched >= 7);
    CHECK(skipped >= came / 4);
    CHECK(bench.run_until([&] { return bench.pose_known(); }));

    // What was said in a quarter of a second arrives in one piece.
    for (int i = 0; i < 3; ++i) {
        bench.urg.hold(true);
        REQUIRE(bench.run_for(0.25));
        bench.urg.hold(false);
        REQUIRE(bench.run_for(0.15));
    }
    CHECK(bench.run_until([&] { return bench.pose_known(); }));

    const std::uint64_t before = troubles();
    bench.urg.lose(0.5);
    REQUIRE(bench.run_for(2.0));
    INFO(bench.service->status().dump(1));
    CHECK(troubles() > before);
    CHECK(bench.service->alive());
    bench.urg.lose(0.0);
    CHECK(bench.run_until([&] { return bench.pose_known(); }));
    const Pose2 there = crspf::test::pose_at((monotonic_now() - bench.begun).seconds());
    CHECK(std::hypot(bench.last_pose->P_map_base.x_m - there.x_m, bench.last_pose->P_map_base.y_m - there.y_m) < 0.1);
    bench.service->stop();
}

TEST_CASE("service: a start without sensors does not keep the next one from mapping", "[real-kernel]") {
    const Scratch scratch;
    {
        ServiceOptions options;
        options.allow_degraded = true;
        Service service(crspf::test::robot("/dev/nowhere",
                                           "[service]\nstate_directory = \"" + (scratch / "state").string() + "\"\n"),
                        options);
        service.start();
        service.stop();  // saves a map of nothing, and no pose
    }
    REQUIRE_FALSE(MapStore(scratch / "state").load()->P_map_base);
    Bench bench(scratch.directory());
    bench.service->start();
    CHECK(bench.run_until([&] { return bench.pose_known(); }));
    bench.service->stop();
}

TEST_CASE("service: what is kept is the last pose that was not lost", "[real-kernel]") {
    const Scratch scratch;
    Bench bench(scratch.directory());
    bench.service->start();
    REQUIRE(bench.run_until([&] { return bench.pose_known(); }));
    REQUIRE(bench.run_until(
        [&] { return std::hypot(bench.last_pose->P_map_base.x_m, bench.last_pose->P_map_base.y_m) > 0.2; }));
    bench.urg.unplug();  // sensors lose their power before the computer does
    REQUIRE(bench.run_until([&] { return bench.last_pose->lost; }));
    bench.service->stop();
    const auto saved = MapStore(scratch / "state").load();
    REQUIRE(saved);
    REQUIRE(saved->P_map_base);
    CHECK(std::hypot(saved->P_map_base->x_m, saved->P_map_base->y_m) > 0.15);
}

TEST_CASE("service: what is wrong with saving is told once, and stays in the status") {
    const Scratch scratch;
    const std::filesystem::path state = scratch / "state";
    const std::string settings = "[service]\nsave_every_s = 0.3\nstate_directory = \"" + state.string() + "\"\n";
    {
        MapStore store(state);
        store.save({.width = 1, .height = 1, .resolution_m = 0.02, .P_map_origin = {}, .cells = {GridCell::kFree}},
                   Pose2{});
        store.save({.width = 1, .height = 1, .resolution_m = 0.02, .P_map_origin = {}, .cells = {GridCell::kFree}},
                   Pose2{});
        std::filesystem::resize_file(state / "map-2.pgm", 3);
    }
    ServiceOptions options;
    options.allow_degraded = true;
    Service service(crspf::test::robot("/dev/nowhere", settings), options);
    service.start();
    // The damage of the newest map first; then the directory is gone.
    const std::vector<ServiceEvent> first = service.tick();
    REQUIRE_FALSE(first.empty());
    CHECK(first[0].bad);
    CHECK(first[0].text.find("map-2.pgm: is not what was saved") != std::string::npos);
    std::filesystem::remove_all(state);
    static_cast<void>(scratch.file("state", "in the way"));
    int told = 0;
    const Stamp end = monotonic_now() + Duration{1'500'000'000};
    while (monotonic_now() < end) {
        for (const ServiceEvent& event : service.tick()) {
            told += event.text.find(state.string()) == 0 ? 1 : 0;
        }
        sleep_until(monotonic_now() + Duration{20'000'000});
    }
    CHECK(told == 1);
    CHECK(service.status()["map"]["problem"].get<std::string>().find(state.string()) == 0);
    CHECK_THROWS_AS(service.stop(), InputError);
}

TEST_CASE("service: a map to plan on is at hand while it drives, and is that of the map", "[real-kernel]") {
    const Scratch scratch;
    Config config = Bench::config(scratch.directory());
    config.service.planning_every_s = 0.5;
    Bench bench(scratch.directory(), config);
    bench.service->start();
    const std::filesystem::path yaml = scratch / "state/planning.yaml";
    REQUIRE(bench.run_until([&] { return std::filesystem::exists(yaml); }));
    const auto first = std::filesystem::last_write_time(yaml);
    REQUIRE(bench.run_until([&] { return std::filesystem::last_write_time(yaml) > first; }));
    const GridMap planning = read_grid_map(yaml);
    CHECK(std::count(planning.cells.begin(), planning.cells.end(), GridCell::kOccupied) > 100);
    CHECK(std::count(planning.cells.begin(), planning.cells.end(), GridCell::kFree) > 1000);
    CHECK(bench.service->status()["filter"]["skipped"] == 0);
    bench.service->stop();
}

TEST_CASE("service: a saved map larger than the pool is all there, what is far on the disk, and is saved whole again") {
    const Scratch scratch;
    constexpr int kTilesAcross = 100;
    constexpr int kTilesDown = 73;
    constexpr int kSide = TileGeometry::kSide;
    GridMap map{.width = kTilesAcross * kSide,
                .height = kTilesDown * kSide,
                .resolution_m = 0.02,
                .P_map_origin = {.x_m = -0.02 * kSide * 3, .y_m = -0.02 * kSide * 3, .theta_rad = 0.0},
                .cells = {}};
    map.cells.assign(static_cast<std::size_t>(map.width) * static_cast<std::size_t>(map.height), GridCell::kFree);
    map.cells.back() = GridCell::kOccupied;
    MapStore(scratch / "state").save(map, Pose2{});
    ServiceOptions options;
    options.allow_degraded = true;
    Service service(
        crspf::test::robot("/dev/nowhere", "[service]\nstate_directory = \"" + (scratch / "state").string() + "\"\n"),
        options);
    service.start();
    static_cast<void>(service.tick());
    const auto status = service.status();
    CHECK(status["map"]["tiles"] == capacity::kTilesKept);
    CHECK(status["map"]["tiles_on_disk"] == std::size_t{kTilesAcross} * kTilesDown - capacity::kTilesKept);
    CHECK(status["map"]["problem"].get<std::string>().empty());
    service.stop();
    const auto saved = MapStore(scratch / "state").load();
    REQUIRE(saved);
    CHECK(saved->yaml == scratch / "state/map-2.yaml");
    CHECK(saved->map.cells == map.cells);
}

TEST_CASE("service: says what is missing") {
    const Scratch scratch;
    const std::string state = "[service]\nstate_directory = \"" + (scratch / "state").string() + "\"\n";
    CHECK_THROWS_WITH(Service(parse_config(state, "a.toml"), {}), Catch::Contains("no lidar is configured"));
    CHECK_THROWS_WITH(Service(crspf::test::robot("/dev/nowhere", state + "localize_only = true\n"), {}),
                      Catch::Contains("no map is saved there to localise on"));
}

TEST_CASE("service: a thread that hangs is seen") {
    /// Hears nothing and comes back too late.
    class Hanging final : public LiveSource {
     public:
        void step(Duration /*wait*/, SampleSink& /*samples*/, TrafficSink& /*traffic*/) override {
            sleep_until(monotonic_now() + Duration{2'500'000'000});
        }
        [[nodiscard]] LiveReport report() const override { return {}; }
    };
    /// Hears nothing, in time.
    class Quiet final : public LiveSource {
     public:
        void step(Duration wait, SampleSink& /*samples*/, TrafficSink& /*traffic*/) override {
            sleep_until(monotonic_now() + wait);
        }
        [[nodiscard]] LiveReport report() const override { return {}; }
    };
    const Scratch scratch;
    const bool hangs = GENERATE(false, true);
    ServiceOptions options;
    options.allow_degraded = true;
    options.open_source = [hangs](const SourceConfig& source, const LidarParams&) -> std::unique_ptr<LiveSource> {
        if (hangs && is_lidar(source.driver)) {
            return std::make_unique<Hanging>();
        }
        return std::make_unique<Quiet>();
    };
    const std::string state = "[service]\nstate_directory = \"" + (scratch / "state").string() + "\"\n";
    Service service(crspf::test::robot("/dev/nowhere", state), options);
    service.start();
    bool was_stuck = false;
    const Stamp end = monotonic_now() + Duration{2'200'000'000};
    while (monotonic_now() < end) {
        was_stuck = was_stuck || !service.alive();
        sleep_until(monotonic_now() + Duration{20'000'000});
    }
    CHECK(was_stuck == hangs);
    service.stop();
}
