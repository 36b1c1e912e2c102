// From the bytes of the sensors to poses.
#include <catch2/catch.hpp>
#include <chrono>
#include <filesystem>
#include <string>
#include <vector>

#include "platform/files/trajectory.hpp"
#include "tests/unit/platform/scratch.hpp"
#include "tests/unit/sim/command.hpp"
#include "tools/crspf/replay.hpp"
#include "tools/eval/ate.hpp"
#include "tools/sim/velodyne_sweep.hpp"

namespace {

using crspf::ReplayJob;
using crspf::run_replay;
using crspf::test::Scratch;

crspf::ReplayOutcome play(const std::filesystem::path& capture, double rate = 0.0) {
    ReplayJob job;
    job.logs = {capture};
    job.rate = rate;
    return run_replay(job);
}

struct Drive {
    Drive(const Scratch& scratch, const std::string& lidar, const std::string& seconds,
          std::vector<std::string> more = {})
        : capture(scratch / "run.pcapng") {
        more.insert(more.end(), {"--world", "office", "--lidar", lidar, "--duration", seconds, "--capture",
                                 capture.string(), "--out", (scratch / "sim").string()});
        crspf::test::crspf_sim(more);
        truth = crspf::read_tum(scratch / "sim/truth.tum");
    }
    std::filesystem::path capture;
    std::vector<crspf::TimedPose> truth;
};

}  // namespace

TEST_CASE("capture: SCIP and CAN bytes become poses near the truth, the same each time", "[replay]") {
    const Scratch scratch;
    const Drive drive(scratch, "urg", "40");
    const auto first = play(drive.capture);
    CHECK(first.trajectory.size() > drive.truth.size() - 5);
    const auto report = crspf::eval::absolute_trajectory_error(first.trajectory, drive.truth, {});
    REQUIRE(report);
    CHECK(report->unmatched == 0);
    CHECK(report->position_m.rms < 0.1);
    CHECK(play(drive.capture).digest == first.digest);

    // A writer that died leaves the poses up to there.
    const std::string whole = crspf::test::content_of(drive.capture);
    const std::filesystem::path cut = scratch.file("cut.pcapng", whole.substr(0, whole.size() / 2));
    const auto half = play(cut);
    REQUIRE(half.trajectory.size() > drive.truth.size() / 3);
    REQUIRE(half.trajectory.size() < first.trajectory.size());
    for (std::size_t i = 0; i < half.trajectory.size(); ++i) {
        REQUIRE(half.trajectory[i].P_map_base == first.trajectory[i].P_map_base);
    }
    // A bit of a wheel's counter tells.
    std::string other = whole;
    const std::size_t at = other.find("\x03\x81", whole.size() / 2);  // the identifier of the left position
    REQUIRE(at != std::string::npos);
    other[at + 8] = static_cast<char>(other[at + 8] ^ 0x10);
    CHECK(play(scratch.file("other.pcapng", other)).digest != first.digest);
}

TEST_CASE("capture: a gyroscope's yaw rate, and a car's steering, serve as well as wheels", "[replay]") {
    for (const auto& more : {std::vector<std::string>{"--odometer", "imu"},
                             std::vector<std::string>{"--odometer", "steering", "--robot", "ackermann"}}) {
        CAPTURE(more);
        const Scratch scratch;
        const Drive drive(scratch, "urg", "20", more);
        const auto replay = play(drive.capture);
        CHECK(replay.trajectory.size() > drive.truth.size() - 5);
        const auto report = crspf::eval::absolute_trajectory_error(replay.trajectory, drive.truth, {});
        REQUIRE(report);
        CHECK(report->position_m.rms < 0.1);
    }
}

TEST_CASE("capture: Velodyne datagrams become poses near the truth", "[replay]") {
    const Scratch scratch;
    const Drive drive(scratch, "velodyne", "10");
    const auto replay = play(drive.capture);
    CHECK(replay.trajectory.size() > drive.truth.size() - 6);
    const auto report = crspf::eval::absolute_trajectory_error(replay.trajectory, drive.truth, {});
    REQUIRE(report);
    CHECK(report->position_m.rms < 0.05);
}

TEST_CASE("capture: the obstacles round a Velodyne serve as well as one of its rings", "[replay]") {
    const Scratch scratch;
    const Drive drive(scratch, "velodyne", "10");
    ReplayJob job;
    job.logs = {drive.capture};
    job.config = crspf::load_config(scratch / "sim/config.toml");
    for (crspf::SourceConfig& source : job.config->sources) {
        source.velodyne_planar = crspf::PlanarScan::kObstacles;
    }
    job.config->slam.obstacles.lidar_height_m = crspf::sim::RobotParams{}.lidar_height_m;
    const auto replay = run_replay(job);
    CHECK(replay.trajectory.size() > drive.truth.size() - 6);
    const auto report = crspf::eval::absolute_trajectory_error(replay.trajectory, drive.truth, {});
    REQUIRE(report);
    CHECK(report->position_m.rms < 0.05);
}

TEST_CASE("capture: at the recorded pace a second takes a second, and gives the same poses", "[replay]") {
    const Scratch scratch;
    const Drive drive(scratch, "urg", "2");
    const auto fast = play(drive.capture);
    const auto begin = std::filesystem::file_time_type::clock::now();
    const auto paced = play(drive.capture, 4.0);
    const std::chrono::duration<double> took = std::filesystem::file_time_type::clock::now() - begin;
    CHECK(took.count() > 0.4);  // never earlier; how much later is the machine's affair
    CHECK(paced.digest == fast.digest);
}
