// What experiments find, where it has to be so on any machine.
#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <string>
#include <variant>
#include <vector>

#include "tests/unit/platform/scratch.hpp"
#include "tools/experiments/carried_run.hpp"
#include "tools/experiments/corners.hpp"
#include "tools/experiments/experiment.hpp"
#include "tools/experiments/live_run.hpp"
#include "tools/experiments/runs.hpp"
#include "tools/experiments/taped_robot.hpp"

using namespace crspf;
using namespace crspf::experiments;

namespace {

bool is_finite(const nlohmann::ordered_json& figures) {
    const nlohmann::ordered_json flat = figures.flatten();
    return std::all_of(flat.begin(), flat.end(), [](const nlohmann::ordered_json& figure) {
        return !figure.is_number() || std::isfinite(figure.get<double>());
    });
}

double lowest_match(const CarriedRun& run, std::size_t from, std::size_t to) {
    double lowest = run.scans.at(from).result.M;
    for (std::size_t i = from; i < to; ++i) {
        lowest = std::min(lowest, run.scans.at(i).result.M);
    }
    return lowest;
}

}  // namespace

TEST_CASE("corners: of a room with a wall that ends in it, seen from one side") {
    // The room is 4 m x 3 m; a wall comes in from the left, another crosses it.
    const sim::World world({{{0.0, 0.0}, {4.0, 0.0}},
                            {{4.0, 0.0}, {4.0, 3.0}},
                            {{4.0, 3.0}, {0.0, 3.0}},
                            {{0.0, 3.0}, {0.0, 0.0}},
                            {{0.0, 1.5}, {2.0, 1.5}},
                            {{2.0, 0.0}, {2.5, 0.1}}});
    const Corners corners(world);
    // Four of the room, where the inner wall begins and ends, and the free end of the last one, which leaves the lower
    // wall at 11 degrees.
    CHECK(corners.points().size() == 7);
    CHECK(corners.seen_near({1.95, 1.5}, 0.1, {1.0, 2.5}));
    CHECK(corners.seen_near({0.05, 2.95}, 0.1, {1.0, 2.5}));
    CHECK_FALSE(corners.seen_near({1.0, 1.5}, 0.1, {1.0, 2.5}));    // the middle of the wall
    CHECK_FALSE(corners.seen_near({0.05, 0.05}, 0.1, {1.0, 2.5}));  // the wall is before it
    CHECK_FALSE(corners.seen_near({2.0, 0.0}, 0.05, {1.0, 0.5}));   // a bend of 11 degrees
}

TEST_CASE("rays: noise is what makes a URG's critical rays miss the corners") {
    const test::Scratch folder;
    double done = 0.0;
    const Findings found =
        rays({.data = folder.directory(), .maps = {}, .scratch = folder.directory(), .progress = [&done](double share) {
                  done = share;
              }});
    CHECK(done == 1.0);
    CHECK(is_finite(found.figures));
    CHECK(found.claims.size() >= 2);
    const auto at_corner = [&](const char* run) { return found.figures[run]["critical_at_corner"].get<double>(); };
    CHECK(at_corner("office_urg_without_noise") > 0.9);
    CHECK(at_corner("office_urg") < 0.5 * at_corner("office_urg_without_noise"));
    const auto plans = std::count_if(found.blocks.begin(), found.blocks.end(), [](const Block& block) {
        const Chart* const chart = std::get_if<Chart>(&block);
        return chart != nullptr && chart->equal_scales && chart->series.size() == 4;
    });
    CHECK(plans == 4);
}

TEST_CASE("match: M falls when the robot is carried on a known map, and the search finds it") {
    sim::SimulationParams robot = urg_robot(1);
    robot.duration_s = 70.0;
    const sim::SampleDrive drive = sim::record_drive(sim::make_scene("office"), robot);
    const SlamParams params = params_for(drive, 1);
    const CarriedRun mapping = run_drive(drive, {.params = params});
    constexpr std::size_t kCarriedAt = 600;
    const std::vector<Carry> carries{{.scan = kCarriedAt, .P_base_told = {.x_m = 1.2, .y_m = 0.9, .theta_rad = 0.6}}};
    const CarriedRun run =
        run_drive(drive, {.params = params, .carries = carries, .map = &mapping.map, .search = true});
    CHECK(lowest_match(run, kCarriedAt - 50, kCarriedAt) > params.analyser.result_on);
    CHECK(lowest_match(run, kCarriedAt, kCarriedAt + 10) < params.analyser.result_off);
    CHECK(run.scans[kCarriedAt].off_m > 1.0);
    CHECK(run.search.found > 0);
    CHECK(run.scans.back().off_m < 0.25);
    // Nobody looks for it: it stays where it is not.
    const CarriedRun alone = run_drive(drive, {.params = params, .carries = carries, .map = &mapping.map});
    CHECK(alone.search.searches == 0);
    CHECK(alone.scans.back().off_m > 0.5);
}

TEST_CASE("live: a taped robot knows its scans, and the recording gives the poses of the service to the bit") {
    const test::Scratch folder;
    double done = 0.0;
    const LiveRun run = run_live(folder.directory(), 4.0, [&done](double share) { done = share; });
    CHECK(done == 1.0);
    CHECK(run.live_other == 0);
    CHECK(run.live_same == run.scans.size());
    CHECK(run.scans.size() > 15);
    CHECK(std::all_of(run.scans.begin(), run.scans.end(), [](const LiveScan& s) { return s.P_world_base; }));
    REQUIRE(run.modules.size() == 8);
    for (const char* const name : {"rx-lidar", "rx-base", "odometry", "filter", "map", "output"}) {
        const auto module =
            std::find_if(run.modules.begin(), run.modules.end(), [&](const ModuleLoad& m) { return m.name == name; });
        REQUIRE(module != run.modules.end());
        CHECK(module->rate_hz > 0.0);
        CHECK(module->cpu_s > 0.0);
        CHECK(module->share.size() == run.interval_s.size());
    }
    CHECK(run.load() > 0.0);
    CHECK(run.replay_scan_ms > 0.0);
}
