#include "tools/mqtt/robot_topics.hpp"

#include <zlib.h>

#include <algorithm>
#include <catch2/catch.hpp>
#include <string>
#include <vector>

#include "platform/files/base64.hpp"
#include "platform/files/input_error.hpp"
#include "tests/unit/view/view_events.hpp"

using namespace crspf;
using namespace crspf::mqtt;
using namespace crspf::view::test;
using Json = nlohmann::ordered_json;

namespace {

constexpr std::int64_t kMillisecond_ns = 1'000'000;

Moment at_ms(std::int64_t ms) {
    return {.now = Stamp{kSecond_ns + ms * kMillisecond_ns}, .utc_ns = kStart_ns + ms * kMillisecond_ns};
}

RobotTopics robot(double pose_hz = 2.0) {
    return RobotTopics({.prefix = "site/a", .robot = "r1", .pose_hz = pose_hz, .version = "0.1.0"}, at_ms(0));
}

std::vector<Publication> all(RobotTopics& topics, Moment moment) {
    std::vector<Publication> out;
    while (auto next = topics.next(moment)) {
        out.push_back(*next);
        REQUIRE(out.size() < 10'000);
    }
    return out;
}

std::vector<std::string> names(const std::vector<Publication>& publications) {
    std::vector<std::string> out;
    out.reserve(publications.size());
    for (const Publication& each : publications) {
        out.push_back(each.topic + (each.payload.empty() ? " gone" : ""));
    }
    std::sort(out.begin(), out.end());
    return out;
}

/// On that topic, in their order.
std::vector<Json> on(const std::vector<Publication>& publications, const std::string& leaf) {
    std::vector<Json> out;
    for (const Publication& each : publications) {
        if (each.topic == "site/a/r1/" + leaf) {
            out.push_back(Json::parse(each.payload));
        }
    }
    return out;
}

view::StatusEvent status_at(std::int64_t ms, const char* state = "ok") {
    return {.stamp_ns = at_ms(ms).utc_ns,
            .status = {{"pose", {{"x_m", 3.0}, {"lost", false}}},
                       {"sources", Json::array({{{"name", "lidar"}, {"state", state}}})}}};
}

view::LogLine line_at(std::int64_t ms, view::LogLine::Level level = view::LogLine::Level::kWarning) {
    return {.stamp_ns = at_ms(ms).utc_ns, .level = level, .text = "line " + std::to_string(ms)};
}

view::TilesEvent tiles(bool fresh, std::vector<TileImage> images) {
    return {.fresh = fresh, .resolution_m = 0.05, .tiles = std::move(images)};
}

using Names = std::vector<std::string>;

}  // namespace

TEST_CASE("robot topics: a connection begins with what the broker is to keep") {
    RobotTopics topics = robot();
    CHECK(names(all(topics, at_ms(0))) == Names{"site/a/r1/online"});
    CHECK(all(topics, at_ms(1)).empty());
    topics.take(status_at(2), at_ms(2));
    topics.take(tiles(true, {tile_at(0, -1, 50)}), at_ms(2));
    CHECK(names(all(topics, at_ms(2))) ==
          Names{"site/a/r1/health", "site/a/r1/map", "site/a/r1/map/0/-1", "site/a/r1/pose"});
    topics.begin();
    const std::vector<Publication> again = all(topics, at_ms(3));
    CHECK(names(again) == Names{"site/a/r1/health", "site/a/r1/map", "site/a/r1/map/0/-1", "site/a/r1/online"});
    CHECK(std::all_of(again.begin(), again.end(), [](const auto& each) { return each.retained && each.acknowledged; }));
    CHECK(again.front().payload == "true");
    CHECK(topics.online(false).payload == "false");
    CHECK(topics.online(false).topic == again.front().topic);
}

TEST_CASE("robot topics: of poses the newest, not oftener than asked for, and none waits") {
    RobotTopics topics = robot(10.0);
    all(topics, at_ms(0));
    std::vector<Publication> out;
    for (std::int64_t ms = 0; ms < 1000; ms += 10) {
        topics.take(scan_at(at_ms(ms).utc_ns, 0.001 * static_cast<double>(ms)), at_ms(ms));
        const auto now = all(topics, at_ms(ms));
        out.insert(out.end(), now.begin(), now.end());
    }
    const std::vector<Json> poses = on(out, "pose");
    REQUIRE(poses.size() == 10);
    for (std::size_t i = 0; i < poses.size(); ++i) {
        CHECK(poses[i]["stamp_ns"] == at_ms(100 * static_cast<std::int64_t>(i)).utc_ns);
    }
    CHECK_FALSE(out.front().retained);
    CHECK_FALSE(out.front().acknowledged);
    // Nobody has taken any for a second: what comes then is one, the newest.
    for (std::int64_t ms = 1000; ms < 2000; ms += 10) {
        topics.take(scan_at(at_ms(ms).utc_ns), at_ms(ms));
    }
    const std::vector<Json> late = on(all(topics, at_ms(2000)), "pose");
    REQUIRE(late.size() == 1);
    CHECK(late[0]["stamp_ns"] == at_ms(1990).utc_ns);
}

TEST_CASE("robot topics: a pose has its units, and without scans it is the service's") {
    RobotTopics topics = robot();
    view::ScanEvent scan = scan_at(kStart_ns, 1.5);
    scan.P_map_base.theta_rad = 7.0;
    scan.matched = true;
    topics.take(scan, at_ms(0));
    topics.take(status_at(0), at_ms(0));
    Json pose = on(all(topics, at_ms(0)), "pose").at(0);
    CHECK(pose["heading_deg"].get<double>() == Approx(41.0704564));
    pose.erase("heading_deg");
    CHECK(pose == Json::parse(R"({"stamp_ns": 1700000000000000000, "x_m": 1.5, "y_m": -2.0,
        "covariance": [1.0, 2.0, 3.0, 4.0, 5.0, 6.0], "M": 2000.0, "matched": true, "result": false,
        "degenerate": false, "lost": false})"));
    topics.take(status_at(1600), at_ms(1600));
    pose = on(all(topics, at_ms(1600)), "pose").at(0);
    CHECK(pose["x_m"] == 3.0);
    CHECK(pose["matched"] == false);
    CHECK(pose["stamp_ns"] == at_ms(1600).utc_ns);
}

TEST_CASE("robot topics: health is told at once where it changes, and from time to time where it does not") {
    RobotTopics topics = robot();
    std::vector<std::int64_t> told;
    for (std::int64_t ms = 0; ms <= 30'000; ms += 100) {
        const bool stale = ms >= 5'000;
        topics.take(status_at(ms, stale ? "stale" : "ok"), at_ms(ms));
        if (!on(all(topics, at_ms(ms)), "health").empty()) {
            told.push_back(ms);
        }
    }
    CHECK(told == std::vector<std::int64_t>{0, 5'000, 15'000, 25'000});
    // It flickers: once a second is enough.
    told.clear();
    for (std::int64_t ms = 40'000; ms < 43'000; ms += 100) {
        topics.take(status_at(ms, ms % 200 == 0 ? "stale" : "ok"), at_ms(ms));
        if (!on(all(topics, at_ms(ms)), "health").empty()) {
            told.push_back(ms);
        }
    }
    CHECK(told.size() <= 4);
    CHECK(told.size() >= 2);
}

TEST_CASE("robot topics: warnings and errors, each once, those from before not, and a bounded number waits") {
    RobotTopics topics = robot();
    topics.take(line_at(-1), at_ms(0));
    topics.take(line_at(1), at_ms(1));
    topics.take(line_at(2, view::LogLine::Level::kInfo), at_ms(2));
    topics.take(line_at(3, view::LogLine::Level::kError), at_ms(3));
    topics.take(line_at(1), at_ms(4));  // the service's log again
    const std::vector<Json> lines = on(all(topics, at_ms(4)), "log");
    REQUIRE(lines.size() == 2);
    CHECK(lines[0] == Json{{"stamp_ns", at_ms(1).utc_ns}, {"level", "warning"}, {"text", "line 1"}});
    CHECK(lines[1]["level"] == "error");

    for (std::int64_t i = 0; i < 60; ++i) {
        topics.take(line_at(100 + i), at_ms(100 + i));
    }
    topics.take(status_at(200), at_ms(200));
    const std::vector<Publication> late = all(topics, at_ms(200));
    REQUIRE(on(late, "log").size() == RobotTopics::kLogMax);
    CHECK(on(late, "log").front()["text"] == "line 110");
    CHECK(on(late, "health").at(0)["counters"]["mqtt.log_lost"] == 10);
}

TEST_CASE("robot topics: a tile is told with its place, and its cells inflate") {
    RobotTopics topics = robot();
    TileImage image = tile_at(-2, 3, 20);
    image.cells[1] = 100;
    image.cells[4095] = TileImage::kUnseen;
    topics.take(tiles(true, {image}), at_ms(7));
    const std::vector<Publication> out = all(topics, at_ms(7));
    const Json about = on(out, "map").at(0);
    CHECK(about == Json::parse(R"({"map_id": 1700000000007, "resolution_m": 0.05, "side_cells": 64,
        "encoding": "zlib+base64", "unseen": 255})"));
    const Json tile = on(out, "map/-2/3").at(0);
    CHECK(tile["map_id"] == about["map_id"]);
    CHECK(tile["x_m"].get<double>() == Approx(-6.4));
    CHECK(tile["y_m"].get<double>() == Approx(9.6));
    const auto deflated = from_base64(tile["cells"].get<std::string>()).value();
    CHECK(deflated.size() < 100);
    std::array<std::uint8_t, 4096> cells{};
    uLongf size = cells.size();
    REQUIRE(::uncompress(cells.data(), &size, deflated.data(), deflated.size()) == Z_OK);
    REQUIRE(size == cells.size());
    CHECK(cells == image.cells);
}

TEST_CASE("robot topics: tiles that change are looked at each two seconds, and told as they are then") {
    RobotTopics topics = robot();
    topics.take(tiles(true, {tile_at(0, 0, 10), tile_at(1, 0, 10)}), at_ms(0));
    all(topics, at_ms(0));
    std::vector<Publication> out;
    for (std::int64_t ms = 100; ms <= 10'000; ms += 100) {
        topics.take(tiles(false, {tile_at(0, 0, static_cast<std::uint8_t>(ms / 100))}), at_ms(ms));
        const auto now = all(topics, at_ms(ms));
        out.insert(out.end(), now.begin(), now.end());
    }
    CHECK(names(out) == Names(5, "site/a/r1/map/0/0"));
}

TEST_CASE("robot topics: of another map the broker forgets the tiles that are not in it") {
    RobotTopics topics = robot();
    topics.take(tiles(true, {tile_at(0, 0, 10), tile_at(1, 0, 10), tile_at(2, 0, 10)}), at_ms(0));
    all(topics, at_ms(0));
    topics.take(tiles(true, {tile_at(1, 0, 30)}), at_ms(5'000));
    const std::vector<Publication> first = all(topics, at_ms(5'000));
    CHECK(names(first) == Names{"site/a/r1/map", "site/a/r1/map/1/0"});
    CHECK(on(first, "map").at(0)["map_id"] == at_ms(5'000).utc_ns / kMillisecond_ns);
    const std::vector<Publication> gone = all(topics, at_ms(8'000));
    CHECK(names(gone) == Names{"site/a/r1/map/0/0 gone", "site/a/r1/map/2/0 gone"});
    CHECK(std::all_of(gone.begin(), gone.end(), [](const auto& each) { return each.retained; }));
    CHECK(all(topics, at_ms(11'000)).empty());
    // Of an empty one, too.
    topics.take(tiles(true, {}), at_ms(12'000));
    all(topics, at_ms(12'000));
    CHECK(names(all(topics, at_ms(15'000))) == Names{"site/a/r1/map/1/0 gone"});
}

TEST_CASE("robot topics: another connection gets the whole map under the same id") {
    RobotTopics topics = robot();
    topics.take(tiles(true, {tile_at(0, 0, 10)}), at_ms(0));
    topics.take(tiles(false, {tile_at(1, 0, 10)}), at_ms(1));
    all(topics, at_ms(1));
    topics.begin();
    const std::vector<Publication> again = all(topics, at_ms(500));
    CHECK(names(again) == Names{"site/a/r1/map", "site/a/r1/map/0/0", "site/a/r1/map/1/0", "site/a/r1/online"});
    CHECK(on(again, "map").at(0)["map_id"] == kStart_ns / kMillisecond_ns);
    CHECK(all(topics, at_ms(5'000)).empty());  // none of them is old
}

TEST_CASE("robot topics: what cannot stand in a topic is refused") {
    const auto made = [](const std::string& prefix, const std::string& name) {
        return RobotTopics({.prefix = prefix, .robot = name, .pose_hz = 1.0, .version = {}}, at_ms(0));
    };
    CHECK_NOTHROW(made("fleet/hall 3", "R-7"));
    for (const char* const bad : {"", "a+", "#", "$SYS", "/a", "a/", "a\nb"}) {
        CAPTURE(bad);
        CHECK_THROWS_WITH(made(bad, "r"), Catch::Contains("--prefix"));
        CHECK_THROWS_WITH(made("p", bad), Catch::Contains("--robot"));
    }
    CHECK_THROWS_AS(made("p", "a/b"), InputError);
    CHECK_THROWS_AS(made("p", std::string("a\0b", 3)), InputError);
    CHECK_THROWS_AS(made("p", std::string(129, 'x')), InputError);
}
