// What the real-time threads do in a turn stays off the heap. (That the guard sees one that does not: test_heap.cpp of
// the replay tests, and the control below.)
#include <sys/prctl.h>
#include <sys/socket.h>

#include <algorithm>
#include <array>
#include <catch2/catch.hpp>
#include <cstdint>
#include <memory>
#include <string>
#include <thread>
#include <vector>

#include "platform/crspfd/output_module.hpp"
#include "platform/crspfd/source_thread.hpp"
#include "platform/linux/monotonic_clock.hpp"
#include "platform/linux/socketcan.hpp"
#include "tests/support/heap_guard.hpp"
#include "tests/support/live_robot.hpp"
#include "tests/support/service_bench.hpp"
#include "tests/unit/crspfd/drive.hpp"
#include "tests/unit/drivers/scip_bench.hpp"
#include "tests/unit/platform/scratch.hpp"
#include "tools/sim/live_sensors.hpp"

using namespace crspf;
using namespace crspf::test;

TEST_CASE("heap: the modules' turns do not allocate") {
    if (!HeapGuard::available()) {
        WARN("skipped: a sanitizer owns malloc");
        return;
    }
    Modules modules;
    Drive drive;
    std::array<int, 2> pair{};
    REQUIRE(::socketpair(AF_UNIX, SOCK_DGRAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0, pair.data()) == 0);
    SocketCan controller{UniqueFd(pair[0])};
    OutputModule output(PoseOutputConfig{}, *modules.exchange, std::make_unique<SocketCan>(UniqueFd(pair[1])));
    modules.exchange->scans_watched = true;  // what watchers want is part of it
    std::uint64_t scans_shown = 0;
    std::uint64_t tiles_shown = 0;
    std::uint64_t calls = 0;
    std::uint64_t frames = 0;
    for (int i = 0; i < 60; ++i) {
        modules.exchange->picture_order.store(
            {.number = static_cast<std::uint16_t>(1 + i / 5), .watched = true, .whole = i < 5});
        const auto samples = drive.wheels();
        const auto scan = std::make_unique<Scan>(drive.scan());
        const HeapGuard guard;
        for (const DifferentialSample& sample : samples) {
            modules.now = sample.stamp;
            static_cast<void>(modules.exchange->motions.push({.sample = sample, .received = modules.now}));
            static_cast<void>(modules.odometry->turn(modules.now));
        }
        modules.exchange->scan.slot().scan = *scan;
        modules.exchange->scan.publish();
        static_cast<void>(modules.filter_turn());
        static_cast<void>(modules.map->turn());
        scans_shown += modules.exchange->watched.update() ? 1U : 0U;
        while (const PictureTile* const tile = modules.exchange->picture.front()) {
            tiles_shown += tile->end ? 0U : 1U;
            modules.exchange->picture.pop();
        }
        output.turn(monotonic_now());
        CanFrame frame;
        while (controller.receive(frame, {}).status == IoStatus::kOk) {
            ++frames;
        }
        calls += guard.calls();
    }
    CHECK(calls == 0);
    CHECK(frames == 60 * kPoseFrames);
    CHECK(scans_shown == 60);
    CHECK(tiles_shown > 60);
    CHECK(modules.filter_state().result.result);
}

TEST_CASE("heap: finding obstacles, and an IMU of six axes, do not allocate") {
    if (!HeapGuard::available()) {
        WARN("skipped: a sanitizer owns malloc");
        return;
    }
    Modules modules;
    modules.exchange->cloud = std::make_unique<LatestValue<ReceivedCloud>>();
    Drive drive;
    std::uint64_t calls = 0;
    for (int i = 0; i < 20; ++i) {
        static_cast<void>(drive.wheels());
        const auto cloud = cloud_of(drive.scan(), params().obstacles.lidar_height_m);
        const ImuSample sample{.stamp = drive.now(),
                               .yaw_rate_radps = kDriveSpeed_mps / kDriveRadius_m,
                               .speed_mps = kDriveSpeed_mps,
                               .inertial = Inertial{.acceleration_z_mps2 = 9.81}};
        const HeapGuard guard;
        modules.now = sample.stamp;
        static_cast<void>(modules.exchange->motions.push({.sample = sample, .received = modules.now}));
        static_cast<void>(modules.odometry->turn(modules.now));
        modules.exchange->cloud->slot().cloud.take(*cloud);
        modules.exchange->cloud->publish();
        static_cast<void>(modules.filter_turn());
        static_cast<void>(modules.map->turn());
        calls += guard.calls();
    }
    CHECK(calls == 0);
    CHECK(modules.filter_state().counters.matched == 20);
}

TEST_CASE("heap: listening to a lidar does not allocate, nor does losing it", "[real-kernel]") {
    if (!HeapGuard::available()) {
        WARN("skipped: a sanitizer owns malloc");
        return;
    }
    const Scratch scratch;
    sim::LiveUrg urg({.link = scratch / "tty", .sensor = urg_04lx(), .scan = revolution});
    const Config config = robot(scratch / "tty");
    const auto exchange = std::make_unique<Exchange>();
    Wakeup odometry;
    Wakeup filter;
    const SourceConfig& lidar = config.sources[1];
    SourceThread source(lidar, open_live(lidar, config.slam.lidar), *exchange, odometry, filter);
    ThreadHealth health;
    std::uint64_t calls = 0;
    const auto run_until = [&](const auto& done) {
        const Stamp end = monotonic_now() + Duration::from_seconds(20.0);
        while (!done() && monotonic_now() < end) {
            const HeapGuard guard;
            source.turn(health, Duration{5'000'000});
            calls += guard.calls();
        }
    };
    run_until([&] { return source.samples() > 5; });
    CHECK(source.report().streaming);
    const std::uint64_t before = source.samples();
    CHECK(before > 5);
    urg.unplug();
    run_until([&] { return !source.report().streaming; });
    CHECK_FALSE(source.report().streaming);
    urg.garble(50);
    urg.plug_in();
    run_until([&] { return source.samples() > before + 5; });
    CHECK(source.samples() > before + 5);
    CHECK(calls == 0);
}

TEST_CASE("heap: the threads of the running service do not allocate", "[real-kernel]") {
    if (!HeapGuard::available()) {
        WARN("skipped: a sanitizer owns malloc");
        return;
    }
    const Scratch scratch;
    ServiceBench bench(scratch.directory());
    bench.service->start();
    REQUIRE(bench.run_until([&bench] { return bench.pose_known(); }));
    const nlohmann::ordered_json threads = bench.service->status()["threads"];
    CHECK(threads.size() == kServiceThreads.size());
    for (const auto& thread : threads) {  // or the watch would look at nothing
        CHECK(std::count(kServiceThreads.begin(), kServiceThreads.end(), thread["name"].get<std::string>()) == 1);
    }
    // Somebody watches for a while, and again.
    WatchBoard board;
    WatchCursor watcher;
    std::size_t shown = 0;
    const auto run_watched = [&](bool watched, double seconds) {
        const Stamp end = monotonic_now() + Duration::from_seconds(seconds);
        board.watched(watched);
        bench.run_until(
            [&] {
                bench.service->show(board);
                shown += board.next(watcher).empty() ? 0U : 1U;
                return monotonic_now() >= end;
            },
            seconds + 1.0);
    };
    {
        const HeapWatch watch(kServiceThreads);
        run_watched(true, 2.0);
        bench.urg.unplug();
        run_watched(false, 0.5);
        bench.urg.plug_in();
        run_watched(true, 2.0);
        const std::uint64_t calls = watch.calls();
        CHECK(calls == 0);
    }
    CHECK(shown > 20);
    bench.service->stop();
}

TEST_CASE("heap: control, an allocation of a watched thread is seen, that of another is not") {
    if (!HeapGuard::available()) {
        WARN("skipped: a sanitizer owns malloc");
        return;
    }
    const auto calls_of = [](const char* name) {
        const HeapWatch watch(kServiceThreads);
        std::thread thread([name] {
            ::prctl(PR_SET_NAME, name);
            const std::vector<std::string> words(3, "longer than what a string holds within");
        });
        thread.join();
        return watch.calls();
    };
    CHECK(calls_of("filter") >= 4);
    CHECK(calls_of("writer") == 0);
}

TEST_CASE("heap: control, a report that is made into a string is seen") {
    if (!HeapGuard::available()) {
        WARN("skipped: a sanitizer owns malloc");
        return;
    }
    const LiveReport report{
        .streaming = true, .state = StateText("streaming, URG-04LX, serial H0000000"), .counts = {}};
    const HeapGuard guard;
    const std::string text(report.state.view());
    const std::uint64_t calls = guard.calls();
    CHECK(calls >= 1);
    CHECK(text.size() > 20);
}
