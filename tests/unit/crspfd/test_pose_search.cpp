// A robot that is lost is looked for, beside the modules.
#include <catch2/catch.hpp>
#include <cmath>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "platform/crspfd/pose_search.hpp"
#include "platform/files/input_error.hpp"
#include "platform/linux/monotonic_clock.hpp"
#include "platform/service/map_image.hpp"
#include "tests/unit/crspfd/drive.hpp"

using namespace crspf;
using namespace crspf::test;

namespace {

/// The modules with a lap in their map, and a search of which each turn is one of the control thread's.
class LostRobot {
 public:
    explicit LostRobot(bool when_lost) : search(*modules.exchange, when_lost) {
        for (int i = 0; i < 60; ++i) {
            scan();
        }
    }
    void scan() {
        modules.wheels(drive);
        modules.scan(drive.scan());
        REQUIRE(modules.filter_turn());
        while (modules.map->turn()) {
        }
    }
    std::optional<FilterCommand> turn(bool lost) {
        return search.turn(
            now, lost, [this] { return export_map(modules.map->map(), params().map.resolution_m); }, events);
    }
    /// Until a search has come to its end.
    std::optional<FilterCommand> look(bool lost) {
        const std::uint64_t before = search.state().searches;
        const Stamp end = monotonic_now() + Duration{60'000'000'000};  // under a sanitizer it takes its time
        // It drives on meanwhile, as far as its wheels can be believed.
        for (int scans = 0; monotonic_now() < end; ++scans) {
            if (scans < 20) {
                scan();
            }
            if (std::optional<FilterCommand> found = turn(lost); found || search.state().searches > before) {
                return found;
            }
            sleep_until(monotonic_now() + Duration{5'000'000});
        }
        FAIL("no end of the search");
        return std::nullopt;
    }

    Modules modules;
    Drive drive;
    PoseSearch search;
    std::vector<ServiceEvent> events;
    Stamp now{1'000'000'000};
};

}  // namespace

TEST_CASE("pose search: a lost robot is found, and is where it was found plus what it has moved") {
    LostRobot robot(true);
    const Pose2 before = robot.modules.filter_state().result.P_map_base;
    const std::optional<FilterCommand> found = robot.look(true);
    INFO(robot.search.state().last_words);
    REQUIRE(found);
    REQUIRE(found->P_odom_base);
    CHECK(robot.search.state().found == 1);
    REQUIRE(robot.events.size() == 1);
    CHECK_FALSE(robot.events[0].bad);
    CHECK(robot.events[0].text.find("found at") != std::string::npos);
    // Placed there it matches at once: it was right, up to the hall's own likeness.
    const Pose2 jump = inverse(before) * found->P_map_base;
    CHECK(std::hypot(jump.x_m, jump.y_m) < 1.0);
    REQUIRE(robot.modules.exchange->commands.push(*found));
    robot.scan();
    CHECK(robot.modules.filter_state().result.result);
}

TEST_CASE("pose search: it rests between two searches, and is not on while the robot is not lost") {
    LostRobot robot(true);
    for (int i = 0; i < 5; ++i) {
        robot.scan();
        CHECK_FALSE(robot.turn(false));
    }
    CHECK_FALSE(robot.modules.exchange->scans_wanted);
    static_cast<void>(robot.look(true));
    CHECK(robot.search.state().searches == 1);
    for (int i = 0; i < 5; ++i) {
        robot.scan();
        CHECK_FALSE(robot.turn(true));
    }
    CHECK_FALSE(robot.search.state().searching);
    robot.now = robot.now + PoseSearch::kPause + Duration{1};
    static_cast<void>(robot.look(true));
    CHECK(robot.search.state().searches == 2);
}

TEST_CASE("pose search: one that found itself meanwhile stays where it is, unless somebody asked") {
    const bool asked = GENERATE(false, true);
    LostRobot robot(true);
    if (asked) {
        CHECK(robot.search.ask() == 1);
    }
    while (!robot.search.state().searching) {
        robot.scan();
        CHECK_FALSE(robot.turn(!asked));
    }
    CHECK(robot.search.ask() == 2);  // begun before: the next one answers
    const std::optional<FilterCommand> found = robot.look(false);
    CHECK(robot.search.state().found == 1);
    CHECK(found.has_value() == asked);
}

TEST_CASE("pose search: switched off it looks only when it is asked to") {
    LostRobot robot(false);
    for (int i = 0; i < 5; ++i) {
        robot.scan();
        CHECK_FALSE(robot.turn(true));
    }
    CHECK(robot.search.state().searches == 0);
    robot.search.ask();
    static_cast<void>(robot.look(true));
    CHECK(robot.search.state().searches == 1);
}

TEST_CASE("pose search: without a scan the asker gets an answer") {
    LostRobot robot(true);
    CHECK(robot.search.ask() == 1);
    CHECK_FALSE(robot.turn(false));
    robot.now = robot.now + PoseSearch::kScanMax + Duration{1};
    CHECK_FALSE(robot.turn(false));
    CHECK(robot.search.state().searches == 1);
    CHECK(robot.search.state().last_words == "no answer: no scan has come");
    CHECK(std::string(verdict_name(robot.search.state().last.verdict)) == "no answer");
}

TEST_CASE("pose search: an empty map, or one that cannot be had, is said") {
    LostRobot robot(true);
    robot.scan();
    bool given = false;
    const std::function<GridMap()> no_map = [&given]() -> GridMap {
        if (std::exchange(given, true)) {
            return {.width = 1, .height = 1, .resolution_m = 0.05, .P_map_origin = {}, .cells = {GridCell::kUnknown}};
        }
        throw InputError("the map thread does not answer");
    };
    for (int i = 0; i < 3; ++i) {
        CHECK_FALSE(robot.search.turn(robot.now, true, no_map, robot.events));
        robot.scan();
    }
    REQUIRE(robot.events.size() == 1);
    CHECK(robot.events[0].text == "the robot is not looked for: the map thread does not answer");
    robot.now = robot.now + PoseSearch::kPause + Duration{1};
    while (robot.search.state().searches == 0) {
        robot.scan();
        CHECK_FALSE(robot.search.turn(robot.now, true, no_map, robot.events));
    }
    INFO(robot.search.state().last_words);
    CHECK(robot.search.state().found == 0);
    CHECK(robot.events.size() == 2);
}
