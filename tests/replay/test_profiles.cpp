// The profiles of config/examples for the paper's platforms, each driven in simulation by the robot that it describes:
// its sensors' bytes, as they come from its lines, become poses near the truth, and every byte is explained.
#include <algorithm>
#include <array>
#include <catch2/catch.hpp>
#include <cstdio>
#include <filesystem>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "config/config.hpp"
#include "platform/files/trajectory.hpp"
#include "tests/unit/eval/recordings.hpp"
#include "tests/unit/platform/scratch.hpp"
#include "tests/unit/sim/command.hpp"
#include "tools/crspf/replay.hpp"
#include "tools/eval/ate.hpp"

namespace {

using namespace crspf;
using test::Scratch;

std::filesystem::path profile(const std::string& name) {
    return std::filesystem::path(CRSPF_SOURCE_DIR) / "config/examples" / (name + ".toml");
}

struct Drive {
    Drive(const std::filesystem::path& config, std::vector<std::string> more) : capture(scratch / "run.pcapng") {
        more.insert(more.end(), {"--config", config.string(), "--odom-scale-error", "0.01", "--capture",
                                 capture.string(), "--out", scratch.directory().string()});
        test::crspf_sim(more);
        truth = read_tum(scratch / "truth.tum");
    }
    Scratch scratch;
    std::filesystem::path capture;
    std::vector<TimedPose> truth;
};

ReplayOutcome play(const std::filesystem::path& run, const std::optional<Config>& config) {
    ReplayJob job;
    job.logs = {run};
    job.config = config;
    return run_replay(job);
}

/// What a source counted that is not a sample, a scan, or how many packets these came in.
std::string complaints(const ReplayOutcome& outcome) {
    constexpr std::array<std::string_view, 4> kGood{"samples", "scans", "packets", "telegrams"};
    std::string out;
    for (const SourceReport& source : outcome.sources) {
        for (const auto& [name, count] : source.counts) {
            if (count > 0 && std::find(kGood.begin(), kGood.end(), name) == kGood.end()) {
                out += source.name + " " + name + " " + std::to_string(count) + "; ";
            }
        }
        if (source.counts.begin()->second == 0) {
            out += source.name + " says nothing; ";
        }
    }
    return out;
}

eval::AteReport error(const ReplayOutcome& outcome, const Drive& drive) {
    const auto report = eval::absolute_trajectory_error(outcome.trajectory, drive.truth, {});
    REQUIRE(report);
    return *report;
}

struct Expected {
    double rms_m;
    /// What each of its kind of lidar says of the beginning, where its first scan is not whole or follows from nothing.
    std::string first;
    std::size_t not_scans;  ///< of the truth's poses: at the beginning and end
    std::uint64_t ignored;  ///< records of no configured source: a Velodyne's position datagrams
};

/// The profile serves as it is shipped, and one that is false does not.
void check(const std::string& name, const Drive& drive, const Expected& expected,
           const std::function<void(Config&)>& falsify) {
    const ReplayOutcome outcome = play(drive.capture, load_config(profile(name)));
    const eval::AteReport report = error(outcome, drive);
    std::printf("%s: %zu scans, %.4f m rms, at most %.3f m; %.3f deg\n", name.c_str(), outcome.trajectory.size(),
                report.position_m.rms, report.position_m.max, report.heading_deg.rms);
    CHECK(report.unmatched == 0);
    CHECK(report.position_m.rms < expected.rms_m);
    CHECK(outcome.trajectory.size() + expected.not_scans >= drive.truth.size());
    CHECK(complaints(outcome) == expected.first);
    CHECK(outcome.log.damaged_lines == 0);
    CHECK(outcome.log.stamp_jumps == 0);
    CHECK(outcome.log.ignored_lines == expected.ignored);
    // The capture carries the profile.
    CHECK(play(drive.capture, std::nullopt).digest == outcome.digest);

    Config false_config = load_config(profile(name));
    falsify(false_config);
    const ReplayOutcome astray = play(drive.capture, false_config);
    std::printf("%s, falsified: %.3f m rms; %s\n", name.c_str(), error(astray, drive).position_m.rms,
                complaints(astray).c_str());
    CHECK(error(astray, drive).position_m.rms > 2.0 * expected.rms_m);
}

SignalBinding& signal_of(WheelBinding& wheel) {
    return wheel.signal;
}

/// What the second source's signals are together: the first is the base, for names are in order.
template <class Odometer>
Odometer& odometer(Config& config) {
    return std::get<Odometer>(config.sources.at(0).can.odometer);
}

}  // namespace

TEST_CASE("profiles: an indoor robot, in an office with people", "[replay]") {
    const Drive drive(profile("indoor_robot"), {"--world", "office", "--people", "3", "--duration", "40"});
    check("indoor_robot", drive, {.rms_m = 0.05, .first = "", .not_scans = 0, .ignored = 0}, [](Config& config) {
        signal_of(odometer<WheelParams>(config).right).scale *= -1.0;  // as if it were mounted like the left one
    });
}

TEST_CASE("profiles: a bank robot, in a hall", "[replay]") {
    const Drive drive(profile("bank_robot"), {"--world", "hall", "--people", "3", "--duration", "30"});
    check("bank_robot", drive, {.rms_m = 0.05, .first = "lidar withheld 1; ", .not_scans = 1, .ignored = 0},
          [](Config& config) { signal_of(odometer<WheelParams>(config).left).scale *= -1.0; });
}

TEST_CASE("profiles: a car with a planar lidar, on a campus", "[replay]") {
    const Drive drive(profile("sick_car"), {"--robot", "car", "--world", "campus", "--duration", "20"});
    check("sick_car", drive, {.rms_m = 0.1, .first = "lidar withheld 1; ", .not_scans = 1, .ignored = 0},
          [](Config& config) {  // km/h taken for m/s
              signal_of(odometer<WheelParams>(config).left).scale = 1.0;
              signal_of(odometer<WheelParams>(config).right).scale = 1.0;
          });
}

TEST_CASE("profiles: a car with a Velodyne, in a car park", "[replay]") {
    const Drive drive(profile("parking_car"),
                      {"--robot", "car", "--speed", "3", "--world", "parking", "--duration", "20"});
    check("parking_car", drive,
          {.rms_m = 0.1, .first = "lidar incomplete_revolutions 1; ", .not_scans = 3, .ignored = 20},
          [](Config& config) { odometer<AckermannParams>(config).speed.signal.scale = 3.6; });
}

TEST_CASE("profiles: an all-terrain vehicle, on bumpy ground between trees", "[replay]") {
    const Drive drive(profile("all_terrain"), {"--world", "field", "--bumps", "8", "--duration", "20"});
    check("all_terrain", drive,
          {.rms_m = 0.1, .first = "lidar incomplete_revolutions 1; ", .not_scans = 3, .ignored = 20},
          [](Config& config) { odometer<ImuParams>(config).yaw_rate.scale = 57.3; });

    // A signal that is not there is told.
    Config deaf = load_config(profile("all_terrain"));
    odometer<ImuParams>(deaf).yaw_rate.signal.id += 1;
    CHECK(complaints(play(drive.capture, deaf)).find("base says nothing") != std::string::npos);
}

TEST_CASE("profiles: an IMU on edge is turned upright by its mounting, and useless without", "[replay]") {
    Config config = load_config(profile("all_terrain"));
    config.slam.odometry.imu_roll_rad = radians(90.0);
    config.slam.odometry.imu_pitch_rad = radians(-20.0);
    config.slam.odometry.imu_yaw_rad = radians(35.0);
    const Scratch scratch;
    const std::filesystem::path file = scratch.file("on_edge.toml", print_config(config));
    const Drive drive(file, {"--world", "field", "--bumps", "8", "--duration", "15"});
    const double upright_m = error(play(drive.capture, config), drive).position_m.rms;
    config.slam.odometry.imu_roll_rad = 0.0;
    config.slam.odometry.imu_pitch_rad = 0.0;
    const double on_edge_m = error(play(drive.capture, config), drive).position_m.rms;
    std::printf("IMU on edge: %.4f m rms, %.3f without its mounting\n", upright_m, on_edge_m);
    CHECK(upright_m < 0.02);
    CHECK(on_edge_m > 0.1);
}

TEST_CASE("profiles: a car whose front wheels tell its speed", "[replay]") {
    Config config = load_config(profile("parking_car"));
    config.slam.odometry.front_driven = true;
    const Scratch scratch;
    const Drive drive(scratch.file("front.toml", print_config(config)),
                      {"--robot", "car", "--speed", "3", "--world", "parking", "--duration", "25"});
    const double right_m = error(play(drive.capture, config), drive).position_m.rms;
    config.slam.odometry.front_driven = false;
    const double wrong_m = error(play(drive.capture, config), drive).position_m.rms;
    std::printf("front wheels: %.4f m rms, %.4f if they were the rear's\n", right_m, wrong_m);
    CHECK(right_m < 0.02);
    CHECK(wrong_m > 1.2 * right_m);  // matching hides most of it
}

TEST_CASE("profiles: recordings of their sensors are understood whole", "[replay]") {
    const auto velodyne = test::recording("velodyne/mrpt_sample_velodyne_vlp16_gps.pcap");
    CRSPF_NEED_RECORDING(velodyne);
    for (const char* name : {"all_terrain", "parking_car"}) {
        Config config = load_config(profile(name));
        config.sources.erase(config.sources.begin());               // nobody recorded the bus
        config.sources.at(0).velodyne.source_address = 0x0A000064;  // 10.0.0.100, which somebody had set
        const ReplayOutcome outcome = play(velodyne, config);
        CHECK(complaints(outcome) == "lidar incomplete_revolutions 1; ");
        CHECK(outcome.sources.at(0).records == 293);
        CHECK(outcome.log.ignored_lines == 57);  // position datagrams
        CHECK(outcome.log.damaged_lines == 0);
    }
    const auto urg = test::recording("urg04lx/breezyslam_exp1.dat.xz");
    CRSPF_NEED_RECORDING(urg);
    const ReplayOutcome outcome = play(urg, load_config(profile("indoor_robot")));
    CHECK(outcome.trajectory.size() == 756);
    CHECK(outcome.log.damaged_lines == 0);
}
