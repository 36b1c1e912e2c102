// A car in a car park: a lidar on its roof, speed and steering angle on its bus.
#include <catch2/catch.hpp>
#include <cstdio>
#include <string>
#include <vector>

#include "config/config.hpp"
#include "platform/files/trajectory.hpp"
#include "tests/unit/platform/scratch.hpp"
#include "tests/unit/sim/command.hpp"
#include "tools/crspf/replay.hpp"
#include "tools/eval/ate.hpp"

TEST_CASE("outdoors: round a simulated car park by steering angle and obstacles", "[replay]") {
    using namespace crspf;
    for (const std::string cars : {"0", "10"}) {
        const test::Scratch scratch;
        const std::string capture = (scratch / "run.pcapng").string();
        test::crspf_sim({"--world",
                         "parking",
                         "--robot",
                         "car",
                         "--odometer",
                         "steering",
                         "--lidar",
                         "velodyne",
                         "--speed",
                         "3",
                         "--odom-scale-error",
                         "0.01",
                         "--duration",
                         "25",
                         "--cars",
                         cars,
                         "--capture",
                         capture,
                         "--out",
                         (scratch / "sim").string()});
        ReplayJob job;
        job.logs = {capture};
        job.config = load_config(scratch / "sim/config.toml");
        CHECK(job.config->sources[1].velodyne_planar == PlanarScan::kObstacles);
        const auto replay = run_replay(job);
        const auto report = eval::absolute_trajectory_error(replay.trajectory, read_tum(scratch / "sim/truth.tum"), {});
        REQUIRE(report);
        std::printf("car park, %s cars on the move: %.3f m rms, %.2f deg\n", cars.c_str(), report->position_m.rms,
                    report->heading_deg.rms);
        CHECK(replay.trajectory.size() > 200);
        CHECK(report->position_m.rms < 0.1);
    }
}
