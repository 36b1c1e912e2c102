// The whole service is watched over its socket while its robot drives.
#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <filesystem>
#include <functional>
#include <memory>
#include <utility>
#include <variant>
#include <vector>

#include "platform/crspfd/control_server.hpp"
#include "platform/crspfd/watch_board.hpp"
#include "platform/files/grid_map.hpp"
#include "platform/linux/monotonic_clock.hpp"
#include "tests/support/service_bench.hpp"
#include "tests/unit/crspfd/watched_map.hpp"
#include "tests/unit/platform/scratch.hpp"
#include "tools/view/live_feed.hpp"

using namespace crspf;
using namespace crspf::test;

namespace {

/// What crspfd's main loop does beside the service, and a live feed at the other end.
class Watching {
 public:
    explicit Watching(const Scratch& scratch) : path_(scratch / "control"), feed_(path_) { open(); }

    void open() {
        server_ = std::make_unique<ControlServer>(
            path_, [](const ControlRequest&) { return error_line("nothing"); },
            [this](WatchCursor& cursor) { return board_.next(cursor); });
    }
    void close() { server_.reset(); }
    void turn(Service& service) {
        if (server_ != nullptr) {
            server_->serve({});
            board_.watched(server_->watchers() > 0);
        }
        service.show(board_);
        std::vector<view::RunEvent> events;
        feed_.turn(events);
        for (view::RunEvent& event : events) {
            if (auto* const scan = std::get_if<view::ScanEvent>(&event)) {
                scans.push_back(std::move(*scan));
            } else if (auto* const status = std::get_if<view::StatusEvent>(&event)) {
                statuses.push_back(std::move(*status));
            } else if (const auto* const gone = std::get_if<view::AwayEvent>(&event)) {
                away.push_back(*gone);
            } else if (const auto* const tiles = std::get_if<view::TilesEvent>(&event)) {
                map.take(*tiles);
                map_changed = monotonic_now();
            }
        }
    }

    std::vector<view::ScanEvent> scans;
    std::vector<view::StatusEvent> statuses;
    std::vector<view::AwayEvent> away;
    WatchedMap map;
    Stamp map_changed;

 private:
    std::filesystem::path path_;
    WatchBoard board_;
    std::unique_ptr<ControlServer> server_;
    view::LiveFeed feed_;
};

}  // namespace

TEST_CASE("service: who watches sees its scans and its status, and a map that is the one saved", "[real-kernel]") {
    const Scratch scratch;
    Watching watching(scratch);
    const std::int64_t begun_ns = clock_now(CLOCK_REALTIME).ns;
    {
        ServiceBench bench(scratch.directory());
        const auto until = [&](const std::function<bool()>& done) {
            return bench.run_until([&] {
                watching.turn(*bench.service);
                return done();
            });
        };
        bench.service->start();
        REQUIRE(until([&] {
            return watching.scans.size() > 20 && watching.scans.back().result &&
                   std::hypot(watching.scans.back().P_map_base.x_m, watching.scans.back().P_map_base.y_m) > 0.3;
        }));
        REQUIRE(watching.away.size() == 1);
        CHECK_FALSE(watching.away[0].away);
        const view::ScanEvent& scan = watching.scans.back();
        CHECK(scan.matched);
        CHECK_FALSE(scan.lost);
        CHECK(scan.points.size() > 300);
        CHECK(scan.critical_rays > 0);
        CHECK(scan.range_m > 0.0);
        CHECK(scan.covariance.xx > 0.0);
        CHECK(scan.stamp_ns > begun_ns);
        CHECK(scan.stamp_ns < clock_now(CLOCK_REALTIME).ns);
        // The robot's points lie on the room's walls (live_robot.hpp): within its corners.
        for (const view::ScanEvent::Point& point : scan.points) {
            const Pose2 there =
                scan.P_map_base *
                Pose2{.x_m = static_cast<double>(point.x_m), .y_m = static_cast<double>(point.y_m), .theta_rad = 0.0};
            CHECK((there.x_m > -2.2 && there.x_m < 3.2 && there.y_m > -1.7 && there.y_m < 2.7));
        }
        for (std::size_t i = 1; i < watching.scans.size(); ++i) {
            CHECK(watching.scans[i].stamp_ns > watching.scans[i - 1].stamp_ns);
        }
        REQUIRE(watching.statuses.size() >= 2);
        CHECK(watching.statuses.back().status["filter"]["scans"].get<int>() > 10);

        // It stands still for who draws, and the two maps are one.
        bench.urg.unplug();
        REQUIRE(
            until([&] { return monotonic_now() - watching.map_changed > Duration{4 * WatchFeed::kPicturePeriod.ns}; }));
        const GridMap saved = read_grid_map(bench.service->save_map());
        const GridMap watched = watching.map.grid();
        CHECK(watched.width == saved.width);
        CHECK(watched.height == saved.height);
        CHECK(watched.P_map_origin.x_m == Approx(saved.P_map_origin.x_m));
        CHECK(watched.P_map_origin.y_m == Approx(saved.P_map_origin.y_m));
        CHECK(watched.cells == saved.cells);
        CHECK(std::count(watched.cells.begin(), watched.cells.end(), GridCell::kOccupied) > 100);
        CHECK(watching.map.beginnings == 1);
        bench.service->stop();
    }
    // The service begins anew: within its process the connection stays, and the map begins anew.
    ServiceBench bench(scratch.directory());
    bench.service->start();
    const auto until = [&](const std::function<bool()>& done) {
        return bench.run_until([&] {
            watching.turn(*bench.service);
            return done();
        });
    };
    REQUIRE(until([&] { return watching.map.beginnings == 2 && watching.map.size() > 5; }));
    CHECK(watching.away.size() == 1);
    // With its process, and its socket, it is away, and back.
    watching.close();
    REQUIRE(until([&] { return watching.away.size() == 3; }));  // it hangs up, then nobody listens
    CHECK(watching.away.back().away);
    watching.open();
    REQUIRE(until([&] { return watching.map.beginnings == 3 && watching.map.size() > 5; }));
    CHECK_FALSE(watching.away.back().away);
    bench.service->stop();
}
