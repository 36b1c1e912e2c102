// Robots whose odometer is an IMU and nothing else: their speed is what the scans show.
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

namespace {

using namespace crspf;

struct Outcome {
    double rms_m = 0.0;
    std::uint64_t lost = 0;
};

Outcome replay(const std::filesystem::path& sim, const std::string& capture, bool feedback) {
    ReplayJob job;
    job.logs = {capture};
    std::string text = test::content(sim / "config.toml");
    if (!feedback) {  // a speed is told, and it is always 0
        text += "[source.base.speed]\nsignal = \"RateOfTurn.GyroX\"\nscale = 1e-12\n";
    }
    job.config = parse_config(text, (sim / "config.toml").string());
    Outcome outcome;
    job.on_result = [&](const Scan*, const ScanResult& result) { outcome.lost += result.lost ? 1U : 0U; };
    const auto done = run_replay(job);
    const auto report = eval::absolute_trajectory_error(done.trajectory, read_tum(sim / "truth.tum"), {});
    REQUIRE(report);
    outcome.rms_m = report->position_m.rms;
    return outcome;
}

}  // namespace

TEST_CASE("no speed: a robot in an office, a car in a car park", "[replay]") {
    const std::vector<std::string> robot{"--lidar", "urg", "--duration", "60"};
    const std::vector<std::string> car{"--world",  "parking", "--robot", "car",        "--lidar",
                                       "velodyne", "--speed", "3",       "--duration", "25"};
    for (const std::string odometer : {"gyro", "inertial"}) {
        for (const auto& kind : {robot, car}) {
            const test::Scratch scratch;
            const std::string capture = (scratch / "run.pcapng").string();
            std::vector<std::string> arguments = kind;
            for (const std::string& more :
                 {std::string("--odometer"), odometer, std::string("--odom-rate"), std::string("100"),
                  std::string("--gyro-bias"), std::string("0.5"), std::string("--capture"), capture,
                  std::string("--out"), (scratch / "sim").string()}) {
                arguments.push_back(more);
            }
            test::crspf_sim(arguments);
            const Outcome with = replay(scratch / "sim", capture, true);
            const Outcome without = replay(scratch / "sim", capture, false);
            std::printf("no speed, %s, %s: %.3f m rms; without the speed that the scans show %.3f m\n",
                        kind == car ? "car" : "robot", odometer.c_str(), with.rms_m, without.rms_m);
            CHECK(with.lost == 0);
            CHECK(with.rms_m < 0.1);
            CHECK(without.rms_m > 2.0 * with.rms_m);
        }
    }
}
