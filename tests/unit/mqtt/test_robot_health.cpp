#include "tools/mqtt/robot_health.hpp"

#include <catch2/catch.hpp>
#include <string>

#include "tests/unit/view/view_events.hpp"

using namespace crspf;
using namespace crspf::mqtt;
using Json = nlohmann::ordered_json;

namespace {

constexpr Stamp kNow{1'000'000'000'000};
constexpr Duration kShort{100'000'000};

view::StatusEvent status(const char* text) {
    return {.stamp_ns = 5, .status = Json::parse(text)};
}

view::ScanEvent scan(bool matched, bool degenerate = false, bool lost = false) {
    view::ScanEvent event = view::test::scan_at(1);
    event.matched = matched;
    event.degenerate = degenerate;
    event.lost = lost;
    return event;
}

}  // namespace

TEST_CASE("robot health: the state is a word, the worst first") {
    RobotHealth health;
    CHECK_FALSE(health.known());
    health.take(status(R"({"pose": {"lost": false}})"));
    CHECK(health.known());
    CHECK(health.word(kNow) == std::string("Waiting for a scan"));
    health.take(scan(true), kNow);
    CHECK(health.word(kNow) == std::string("Tracking"));
    health.take(scan(false), kNow);
    CHECK(health.word(kNow) == std::string("Odometry only"));
    health.take(scan(true, true), kNow);
    CHECK(health.word(kNow + RobotHealth::kScansMax) == std::string("One direction unseen"));
    CHECK(health.word(kNow + RobotHealth::kScansMax + kShort) == std::string("No scans"));
    health.take(scan(true, false, true), kNow);
    CHECK(health.word(kNow) == std::string("LOST"));
    health.take(scan(true), kNow);
    health.take(status(R"({"pose": {"lost": true}})"));
    CHECK(health.word(kNow) == std::string("LOST"));
    health.take(view::AwayEvent{.away = true, .why = "gone"});
    CHECK(health.word(kNow) == std::string("Service away"));
    health.take(view::AwayEvent{.away = false, .why = {}});
    CHECK(health.word(kNow) == std::string("Service away"));  // how it is, nobody has said yet
    health.take(status("{}"));
    CHECK(health.word(kNow) == std::string("Waiting for a scan"));
}

TEST_CASE("robot health: the document has what is not as it should be") {
    RobotHealth health;
    health.take(status(R"({"version": 1, "uptime_s": 2.5, "pose": {"M": 2000.5, "result": true},
        "sources": [{"name": "lidar", "state": "stale", "says": "no answer", "samples": 3}],
        "map": {"tiles": 7, "tiles_max": 9, "problem": "disk full"}, "filter": {"skipped": 3, "lost": 0}})"));
    health.take(scan(true), kNow);
    CHECK(health.payload(kNow, 12, "0.1.0") == Json::parse(R"({"stamp_ns": 12, "state": "Tracking", "service": true,
        "why": "", "uptime_s": 2.5, "M": 2000.5, "result": true,
        "sensors": [{"name": "lidar", "state": "stale", "says": "no answer"}], "map": {"tiles": 7, "tiles_max": 9},
        "counters": {"filter.skipped": 3, "map.problem": "disk full"}, "versions": {"crspf": "0.1.0", "status": 1}})"));
    const Json before = health.gist(kNow);
    health.take(status(R"({"uptime_s": 3.5, "sources": [{"name": "lidar", "state": "stale"}]})"));
    CHECK(health.gist(kNow) == before);  // nothing that is told at once
    health.take(status(R"({"uptime_s": 3.5, "sources": [{"name": "lidar", "state": "ok"}]})"));
    CHECK(health.gist(kNow) != before);
}

TEST_CASE("robot health: of a service that is away nothing old is told") {
    RobotHealth health;
    health.take(status(R"({"version": 1, "pose": {"M": 2000}, "sources": [{"name": "lidar", "state": "ok"}]})"));
    health.take(view::AwayEvent{.away = true, .why = "gone"});
    CHECK(health.payload(kNow, 12, "0.1.0") == Json::parse(R"({"stamp_ns": 12, "state": "Service away",
        "service": false, "why": "gone", "versions": {"crspf": "0.1.0"}})"));
}

TEST_CASE("robot health: whatever stands in a status, it is told") {
    for (const char* text : {"[]", "1", R"({"pose": 1, "sources": {"a": 1}, "map": [], "filter": "x"})",
                             R"({"sources": [1, null, {"name": 5, "state": []}]})"}) {
        CAPTURE(text);
        RobotHealth health;
        health.take(status(text));
        CHECK(health.payload(kNow, 1, "0")["state"] == "Waiting for a scan");
        CHECK(health.gist(kNow).is_array());
    }
}
