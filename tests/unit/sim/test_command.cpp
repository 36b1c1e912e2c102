#include <CLI/CLI.hpp>
#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <memory>
#include <sstream>
#include <string>
#include <vector>

#include "config/config.hpp"
#include "platform/capture/log_reader.hpp"
#include "platform/files/grid_map.hpp"
#include "platform/files/input_error.hpp"
#include "platform/files/trajectory.hpp"
#include "tests/unit/sim/command.hpp"

namespace crspf {

namespace {

namespace fs = std::filesystem;
using test::content;
using test::crspf_sim;
using test::TemporaryFolder;

struct Replayed {
    std::size_t scans = 0;
    std::size_t older_scans = 0;  ///< than the odometry before them
    Pose2 P_start_end;            ///< motions added up, or encoder counts integrated
    double stamp_error_s = 0.0;   ///< largest change of a stamp by the reading
    LogCounts counts;
};

Replayed replay(const fs::path& log, const Config& config) {
    const std::unique_ptr<LogReader> reader = open_log(log, config.slam.lidar, config.wheels);
    auto event = std::make_unique<LogEvent>();
    Replayed replayed;
    Stamp odometry;
    while (reader->next(*event)) {
        if (event->kind == LogEvent::Kind::kScan) {
            ++replayed.scans;
            replayed.older_scans += event->scan.stamp < odometry ? 1U : 0U;
            const double change_s = (event->scan.stamp - Stamp{}).seconds() - event->recorded_stamp_s;
            replayed.stamp_error_s = std::max(replayed.stamp_error_s, std::abs(change_s));
        } else if (event->kind == LogEvent::Kind::kMotion) {
            odometry = event->motion.stamp;
            replayed.P_start_end = replayed.P_start_end * event->motion.P_previous_base;
        }
    }
    replayed.counts = reader->counts();
    return replayed;
}

}  // namespace

TEST_CASE("crspf sim writes a log, its truth, the map and a configuration that belong together") {
    const TemporaryFolder folder;
    const fs::path out = folder / "run";
    crspf_sim({"--world", "meeting", "--duration", "30", "--slip", "0", "--lidar", "scan270", "--odom-rate", "100",
               "--out", out.string()});
    const Config config = load_config(out / "config.toml");
    CHECK(config.slam.lidar.P_base_lidar.x_m == Approx(0.145));
    CHECK(config.slam.lidar.range_max_m == Approx(30.0));
    CHECK(config.slam.lidar.time_per_beam_s == Approx(0.025 / 1440.0));
    CHECK(config.slam.odometry.wheel_span_m == Approx(0.33));

    const std::vector<TimedPose> truth = read_tum(out / "truth.tum");
    const Replayed replayed = replay(out / "log.clf", config);
    CHECK(replayed.scans == truth.size());
    CHECK(replayed.counts.damaged_lines == 0);
    CHECK(replayed.counts.stamp_jumps == 0);
    CHECK(replayed.stamp_error_s < 1e-6);
    const Pose2 end = inverse(truth.front().P_map_base) * truth.back().P_map_base;
    CHECK(replayed.P_start_end.x_m == Approx(end.x_m).margin(0.05));
    CHECK(replayed.P_start_end.y_m == Approx(end.y_m).margin(0.05));

    const GridMap map = read_grid_map(out / "world.yaml");
    CHECK(map.resolution_m == Approx(0.025));
    const Pose2 in_map = inverse(map.P_map_origin) * truth.back().P_map_base;
    CHECK(map.at(static_cast<int>(in_map.x_m / 0.025), static_cast<int>(in_map.y_m / 0.025)) == GridCell::kFree);
}

TEST_CASE("crspf sim writes scans behind newer odometry, and they are read with their own stamps") {
    const TemporaryFolder folder;
    const fs::path out = folder / "run";
    crspf_sim({"--duration", "10", "--lidar", "lms", "--odom-rate", "2", "--out", out.string()});
    const Replayed replayed = replay(out / "log.clf", load_config(out / "config.toml"));
    CHECK(replayed.scans == read_tum(out / "truth.tum").size());
    CHECK(replayed.older_scans > replayed.scans / 2);
    CHECK(replayed.counts.odometry == 20);  // the laser lines repeat the motion of the ODOM lines
    CHECK(replayed.counts.damaged_lines == 0);
    CHECK(replayed.counts.stamp_jumps == 0);
    CHECK(replayed.stamp_error_s < 1e-6);
}

TEST_CASE("crspf sim writes the URG's own format") {
    const TemporaryFolder folder;
    const fs::path out = folder / "run";
    crspf_sim({"--format", "dat", "--duration", "10", "--out", out.string()});
    const Replayed replayed = replay(out / "log.dat", load_config(out / "config.toml"));
    CHECK(replayed.scans == read_tum(out / "truth.tum").size());
    CHECK(replayed.counts.damaged_lines == 0);
    std::istringstream first_line(content(out / "log.dat"));
    std::string line;
    std::getline(first_line, line);
    std::istringstream fields(line);
    std::size_t count = 0;
    for (std::string field; fields >> field; ++count) {
    }
    CHECK(count == 24 + 682);
}

TEST_CASE("crspf sim gives the same files for the same command") {
    const TemporaryFolder folder;
    const fs::path a = folder / "a";
    const fs::path b = folder / "b";
    for (const fs::path& out : {a, b}) {
        crspf_sim({"--duration", "10", "--people", "2", "--seed", "5", "--out", out.string()});
    }
    for (const char* name : {"log.clf", "truth.tum", "world.pgm", "config.toml"}) {
        CHECK(content(a / name) == content(b / name));
    }
}

TEST_CASE("crspf sim reads a path and says what is wrong with it") {
    const TemporaryFolder folder;
    const fs::path path = folder / "path.txt";
    const std::string out = (folder / "run").string();
    std::ofstream(path) << "# x y\n1 10\n\n4 10\n";
    crspf_sim({"--path", path.string(), "--out", out});
    CHECK(read_tum(folder / "run/truth.tum").back().P_map_base.x_m == Approx(4.0).margin(0.35));
    std::ofstream(path) << "0.0 1 10 0 0 0 0 1\n1.0 3 10 0 0 0 0 1\n";
    crspf_sim({"--path", path.string(), "--out", out});
    CHECK(read_tum(folder / "run/truth.tum").back().P_map_base.x_m == Approx(3.0).margin(0.35));
    std::ofstream(path) << "1 10\n4 ten\n";
    CHECK_THROWS_WITH(crspf_sim({"--path", path.string(), "--out", out}), Catch::Contains("path.txt:2:"));
    std::ofstream(path) << "1 10\n";
    CHECK_THROWS_AS(crspf_sim({"--path", path.string(), "--out", out}), InputError);
}

TEST_CASE("crspf sim refuses what it cannot do") {
    const TemporaryFolder folder;
    const std::string out = (folder / "run").string();
    const std::vector<std::vector<std::string>> unusable{
        {"--speed", "nan"}, {"--speed", "-1"},    {"--duration", "inf"}, {"--scan-rate", "0"},
        {"--people", "-1"}, {"--lidar", "hdl64"}, {"--start", "1"}};
    for (std::vector<std::string> arguments : unusable) {
        CAPTURE(arguments[0], arguments[1]);
        arguments.emplace_back("--out");
        arguments.push_back(out);
        CHECK_THROWS_AS(crspf_sim(arguments), CLI::ParseError);
    }
    CHECK_THROWS_AS(crspf_sim({"--world", "moon", "--out", out}), InputError);
    CHECK_THROWS_AS(crspf_sim({"--lidar-x", "0.5", "--out", out}), InputError);
    CHECK_THROWS_AS(crspf_sim({"--lidar", "lms", "--format", "dat", "--out", out}), InputError);
    CHECK_THROWS_AS(crspf_sim({"--start", "0,0", "--out", out}), InputError);
    CHECK_THROWS_AS(crspf_sim({"--out", "/dev/null/run"}), InputError);
    CHECK_FALSE(fs::exists(folder / "run/log.clf"));
}

}  // namespace crspf
