#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <sstream>
#include <string>
#include <variant>
#include <vector>

#include "core/base/trig.hpp"
#include "platform/files/input_error.hpp"
#include "tests/unit/platform/scratch.hpp"
#include "tools/view/replay_player.hpp"

namespace {

using namespace crspf::view;
using crspf::Duration;
using crspf::InputError;
using crspf::ReplayJob;
using crspf::Stamp;
using crspf::test::Scratch;
using Json = nlohmann::json;

constexpr Duration kPlenty{60'000'000'000};
constexpr int kScans = 101;  // ten seconds of ten a second

/// A robot that stands in a room of 6 m x 4 m.
std::string log_of_room() {
    constexpr int kBeams = 181;
    std::string beams;
    for (int i = 0; i < kBeams; ++i) {
        const double angle = crspf::radians(i - 90.0);
        const double across = std::abs(std::sin(angle)) > 1e-9 ? 2.0 / std::abs(std::sin(angle)) : 1e9;
        const double ahead = std::abs(std::cos(angle)) > 1e-9 ? 3.0 / std::abs(std::cos(angle)) : 1e9;
        beams += ' ';
        beams += std::to_string(std::min(across, ahead));
    }
    std::ostringstream log;
    for (int i = 0; i < kScans; ++i) {
        const std::string stamp = std::to_string(976052857.0 + 0.1 * i);
        log << "ODOM 0 0 0 0 0 0 " << stamp << " host " << stamp << "\nFLASER " << kBeams << beams << " 0 0 0 0 0 0 "
            << stamp << " host " << stamp << "\n";
    }
    return log.str();
}

struct Played {
    explicit Played(double speed = 1.0) : feed(job()), player(feed, speed, out()) {}

    [[nodiscard]] ReplayJob job() const {
        ReplayJob made;
        made.logs = {scratch.file("room.clf", log_of_room())};
        return made;
    }
    [[nodiscard]] ReplayPlayer::Out out() {
        return [this](const RunEvent& event) { events.push_back(event); };
    }
    /// At a time of the caller's clock; forgets what was told before.
    void turn(double at_s, Duration work = kPlenty) {
        events.clear();
        player.turn(Stamp{} + Duration::from_seconds(1000.0 + at_s), work, out());
    }
    /// What the last turn said of itself.
    [[nodiscard]] Json said() const {
        Json last;
        for (const RunEvent& event : events) {
            if (const auto* const status = std::get_if<StatusEvent>(&event)) {
                last = status->status.at("replay");
            }
        }
        return last;
    }
    [[nodiscard]] std::vector<ScanEvent> scans() const {
        std::vector<ScanEvent> all;
        for (const RunEvent& event : events) {
            if (const auto* const scan = std::get_if<ScanEvent>(&event)) {
                all.push_back(*scan);
            }
        }
        return all;
    }

    Scratch scratch;
    std::vector<RunEvent> events;
    ReplayFeed feed;
    ReplayPlayer player;
};

TEST_CASE("A recording is played at its pace, and says where it is", "[replay_player]") {
    Played played;
    CHECK(played.scans().size() == 1);
    played.turn(0.0);
    CHECK(played.scans().empty());
    played.turn(1.0);
    CHECK(played.scans().size() == 10);
    CHECK(played.scans().front().points.size() > 100);
    CHECK(played.said()["position_s"].get<double>() == Approx(1.0).margin(1e-3));
    CHECK(played.said()["paused"] == false);
    CHECK(played.said()["speed"] == 1.0);
}

TEST_CASE("Speed is a factor, now or later", "[replay_player]") {
    Played played(4.0);
    played.turn(0.0);
    played.turn(0.5);
    CHECK(played.feed.position_s() == Approx(2.0).margin(0.11));
    CHECK(played.player.ask({{"speed", 1.0}}).empty());
    played.turn(0.5);
    const double before_s = played.feed.position_s();
    played.turn(1.5);
    CHECK(played.feed.position_s() - before_s == Approx(1.0).margin(0.11));
}

TEST_CASE("Paused it stands still, and goes on where it was", "[replay_player]") {
    Played played;
    played.turn(0.0);
    played.turn(1.0);
    CHECK(played.player.ask({{"paused", true}}).empty());
    played.turn(50.0);
    CHECK(played.scans().empty());
    CHECK(played.said()["paused"] == true);
    CHECK(played.player.ask({{"paused", false}}).empty());
    played.turn(60.0);
    played.turn(60.2);
    CHECK(played.feed.position_s() == Approx(1.2).margin(0.11));
}

TEST_CASE("A position is gone to without the points of scans on the way, back is from the beginning, with another map",
          "[replay_player]") {
    Played played;
    played.turn(0.0);
    CHECK(played.player.ask({{"position_s", 5.0}}).empty());
    played.turn(0.1);
    CHECK(played.feed.position_s() == Approx(5.0).margin(0.11));
    REQUIRE(played.scans().size() > 40);
    const auto with_points = [&] {
        const std::vector<ScanEvent> scans = played.scans();
        return std::count_if(scans.begin(), scans.end(), [](const ScanEvent& scan) { return !scan.points.empty(); });
    };
    CHECK(with_points() == 1);
    CHECK(played.scans().back().points.size() > 100);
    CHECK(played.said()["seeking"] == false);

    CHECK(played.player.ask({{"position_s", 2.0}, {"paused", true}}).empty());
    played.turn(0.2);
    CHECK(played.feed.position_s() == Approx(2.0).margin(0.11));
    CHECK(played.scans().back().points.size() > 100);  // not those of where it was before
    CHECK(std::any_of(played.events.begin(), played.events.end(), [](const RunEvent& event) {
        const auto* const tiles = std::get_if<TilesEvent>(&event);
        return tiles != nullptr && tiles->fresh;
    }));
    played.turn(9.0);
    CHECK(played.scans().empty());  // it is paused there
}

TEST_CASE("A turn does no more than it is given time for", "[replay_player]") {
    Played played;
    played.turn(0.0);
    CHECK(played.player.ask({{"position_s", 5.0}}).empty());
    played.turn(0.1, Duration{0});
    CHECK(played.scans().empty());
    CHECK(played.said()["seeking"] == true);
    played.turn(0.2);
    CHECK(played.said()["seeking"] == false);
}

TEST_CASE("At its end it says how long it was, and play begins again", "[replay_player]") {
    Played played;
    played.turn(0.0);
    CHECK(played.said()["duration_known"] == false);
    played.turn(100.0);
    CHECK(played.said()["ended"] == true);
    CHECK(played.said()["duration_known"] == true);
    CHECK(played.said()["duration_s"].get<double>() == Approx(10.0).margin(0.01));
    CHECK(played.player.ask({{"paused", false}}).empty());
    played.turn(101.0);
    CHECK(played.scans().size() == 1);
    played.turn(102.0);
    CHECK(played.said()["ended"] == false);
    CHECK(played.feed.position_s() == Approx(1.0).margin(0.21));
}

TEST_CASE("What cannot be asked for is refused, and changes nothing", "[replay_player]") {
    Played played;
    played.turn(0.0);
    const Json request =
        GENERATE(Json{{"speed", 0}}, Json{{"speed", 1000}}, Json{{"speed", "fast"}}, Json{{"paused", 1}},
                 Json{{"position_s", -1}}, Json{{"position_s", nullptr}}, Json{{"paused", true}, {"speed", -1}});
    CAPTURE(request.dump());
    CHECK_FALSE(played.player.ask(request).empty());
    played.turn(1.0);
    CHECK(played.said()["paused"] == false);
    CHECK(played.feed.position_s() == Approx(1.0).margin(0.11));
}

TEST_CASE("A recording without a scan is the command's error", "[replay_player]") {
    const Scratch scratch;
    ReplayJob job;
    job.logs = {scratch.file("empty.clf", "# nothing\n")};
    CHECK_THROWS_AS(
        [&] {
            ReplayFeed feed(job);
            const ReplayPlayer player(feed, 1.0, [](const RunEvent& /*event*/) {});
        }(),
        InputError);
}

}  // namespace
