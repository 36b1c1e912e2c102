// `crspf sim --capture` and `--config`, as a user calls them: what is written, and what is refused.
#include <catch2/catch.hpp>
#include <filesystem>
#include <fstream>
#include <memory>
#include <string>
#include <vector>

#include "config/config.hpp"
#include "platform/capture/capture_reader.hpp"
#include "platform/files/input_error.hpp"
#include "platform/files/trajectory.hpp"
#include "tests/unit/sim/command.hpp"
#include "tools/sim/capture_writer.hpp"

namespace crspf {

namespace {

namespace fs = std::filesystem;
using test::content;
using test::crspf_sim;
using test::TemporaryFolder;

}  // namespace

TEST_CASE("crspf sim --capture: what lies beside it, and the same bytes for the same seed") {
    const TemporaryFolder folder;
    const auto run = [&](const char* name, const char* lidar, const char* seed) {
        const fs::path file = folder / name / "run.pcapng";
        crspf_sim({"--duration", "3", "--lidar", lidar, "--seed", seed, "--capture", file.string()});
        return content(file);
    };
    const std::string urg = run("a", "urg", "5");
    CHECK(urg == run("b", "urg", "5"));
    CHECK(urg != run("c", "urg", "6"));
    const std::string velodyne = run("d", "velodyne", "5");
    CHECK(velodyne == run("e", "velodyne", "5"));
    CHECK_FALSE(fs::exists(folder / "d/log.clf"));

    CHECK(content(folder / "a/truth.tum") == content(folder / "b/truth.tum"));
    CHECK(fs::exists(folder / "a/log.clf"));
    CHECK(fs::exists(folder / "a/world.yaml"));
    const std::vector<TimedPose> truth = read_tum(folder / "a/truth.tum");
    CHECK(truth.front().stamp_s == Approx(1767225600.5).epsilon(0.0).margin(1e-5));

    const std::string config = content(folder / "a/config.toml");
    CHECK_THAT(config, Catch::Contains("[source.lidar]\ndriver = \"scip\"\nport = \"/dev/ttyACM0\"\n"));
    CHECK_THAT(
        config,
        Catch::Contains(
            "[source.base]\ndriver = \"can\"\nport = \"can0\"\ncanopen_nodes = [1, 2]\ndbc_text = \"\"\"\nBO_ 897 "));
    CHECK_THAT(config,
               Catch::Contains("[source.base.left]\nsignal = \"LeftPosition.LeftPositionActual\"\nscale = 2.4"));
    CHECK_THAT(
        content(folder / "d/config.toml"),
        Catch::Contains("[source.lidar]\ndriver = \"velodyne\"\nport = \"udp://:2368\"\naddress = \"192.168.1.201\"\n"
                        "model = \"VLP-16\"\n"));
    const std::unique_ptr<CaptureReader> reader = open_capture(folder / "a/run.pcapng");
    CaptureRecord record;
    REQUIRE(reader->next(record));
    CHECK(reader->comment() == config);
    CHECK(record.stamp >= Stamp{sim::kCaptureStart_us * 1000});
    CHECK(record.stamp < Stamp{sim::kCaptureStart_us * 1000 + 1'000'000});
    REQUIRE(reader->sources().size() == 2);
    CHECK(reader->sources()[0].name == "lidar");
    CHECK(reader->sources()[1].name == "base");

    crspf_sim({"--duration", "1", "--out", (folder / "log").string(), "--capture", (folder / "x.pcapng").string()});
    CHECK(fs::exists(folder / "log/config.toml"));
    CHECK(fs::exists(folder / "x.pcapng"));
}

TEST_CASE("crspf sim --config: the robot is what the file says, and the capture holds it") {
    const TemporaryFolder folder;
    const std::string profile = std::string(CRSPF_SOURCE_DIR) + "/config/examples/bank_robot.toml";
    const std::string file = (folder / "run.pcapng").string();
    crspf_sim({"--config", profile, "--world", "hall", "--duration", "1", "--capture", file});
    const Config told = load_config(profile);
    const Config carried = load_config(folder / "config.toml");
    CHECK(carried.slam.lidar.P_base_lidar == told.slam.lidar.P_base_lidar);
    CHECK(carried.slam.odometry.wheel_span_m == told.slam.odometry.wheel_span_m);
    const std::unique_ptr<CaptureReader> reader = open_capture(file);
    CaptureRecord record;
    while (reader->next(record)) {
    }
    CHECK(reader->comment() == print_config(told));
    CHECK(reader->sources().at(0).description == "LMS1xx, simulated");

    const auto with = [&](const std::string& more, std::vector<std::string> arguments) {
        const fs::path own = folder / "own.toml";
        std::ofstream(own) << content(folder / "config.toml") << more;
        arguments.insert(arguments.end(), {"--config", own.string(), "--duration", "1", "--capture", file});
        crspf_sim(arguments);
    };
    with("[source.other]\ndriver = \"sick\"\nport = \"tcp://10.0.0.2:2112\"\nrecord_only = true\n", {});
    CHECK_THROWS_WITH(with("", {"--lidar", "urg"}), Catch::Contains("[source.lidar]"));
    CHECK_THROWS_AS(with("", {"--odometer", "imu"}), CLI::ParseError);
    CHECK_THROWS_WITH(crspf_sim({"--config", profile, "--out", (folder / "o").string()}), Catch::Contains("--capture"));
    const std::string parking = std::string(CRSPF_SOURCE_DIR) + "/config/examples/parking_car.toml";
    CHECK_THROWS_WITH(crspf_sim({"--config", parking, "--robot", "differential", "--capture", file}),
                      Catch::Contains("no steering angle"));
    const std::string log = std::string(CRSPF_SOURCE_DIR) + "/config/examples/urg04lx.toml";  // without sources
    CHECK_THROWS_WITH(crspf_sim({"--config", log, "--capture", file}),
                      Catch::Contains("a lidar and a CAN bus, or a stereo camera"));
}

TEST_CASE("crspf sim --capture refuses what no sensor could say") {
    const TemporaryFolder folder;
    const std::string file = (folder / "run.pcapng").string();
    const std::vector<std::vector<std::string>> unusable{{"--lidar", "lms"},
                                                         {"--format", "dat"},
                                                         {"--max-range", "100"},
                                                         {"--lidar", "velodyne", "--scan-rate", "2"},
                                                         {"--lidar", "velodyne", "--max-range", "150"}};
    for (std::vector<std::string> arguments : unusable) {
        CAPTURE(arguments[0], arguments[1]);
        arguments.emplace_back("--capture");
        arguments.push_back(file);
        CHECK_THROWS_AS(crspf_sim(arguments), InputError);
    }
    CHECK_THROWS_WITH(crspf_sim({"--lidar", "velodyne", "--out", (folder / "o").string()}),
                      Catch::Contains("--capture"));
    CHECK_FALSE(fs::exists(file));
    crspf_sim({"--scan-rate", "7.77", "--duration", "2", "--capture", file});  // whole turns a minute
    CHECK(fs::exists(file));
}

}  // namespace crspf
