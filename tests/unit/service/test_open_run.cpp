#include <catch2/catch.hpp>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "platform/capture/frames.hpp"
#include "platform/capture/pcapng_writer.hpp"
#include "platform/files/input_error.hpp"
#include "platform/service/open_run.hpp"
#include "tests/unit/eval/recordings.hpp"
#include "tests/unit/platform/scratch.hpp"

using crspf::CanFrame;
using crspf::Config;
using crspf::Direction;
using crspf::LinkKind;
using crspf::LogEvent;
using crspf::open_run;
using crspf::parse_config;
using crspf::Run;
using crspf::Stamp;
using crspf::test::Scratch;

namespace {

/// Speed in 0.01 m/s and yaw rate in 0.001 rad/s, each in a frame of its own.
std::string car(const std::string& port = "can0") {
    return "[source.base]\ndriver = \"can\"\nport = \"" + port +
           "\"\ndbc_text = \"\"\"\nBO_ 1 Speed: 2 X\n SG_ V : 0|16@1- (0.01,0) [0|0] \\\"\\\" X\n"
           "BO_ 2 Turn: 2 X\n SG_ W : 0|16@1- (0.001,0) [0|0] \\\"\\\" X\n\"\"\"\n"
           "[source.base.speed]\nsignal = \"Speed.V\"\n[source.base.yaw_rate]\nsignal = \"Turn.W\"\n";
}

std::string line(double stamp_s, const std::string& interface, const std::string& frame) {
    char text[80];
    std::snprintf(text, sizeof text, "(%.6f) %s %s\n", stamp_s, interface.c_str(), frame.c_str());
    return text;
}

std::vector<LogEvent> events_of(Run& run) {
    std::vector<LogEvent> out;
    const auto event = std::make_unique<LogEvent>();
    for (const auto& part : run.parts) {
        while (part->next(*event)) {
            out.push_back(*event);
        }
    }
    return out;
}

std::string error_of(const std::vector<std::filesystem::path>& files, const std::optional<Config>& config) {
    try {
        Run run = open_run(files, config);
        static_cast<void>(events_of(run));
        return {};
    } catch (const crspf::InputError& e) {
        return e.what();
    }
}

/// A recording of CAN frames with a configuration in it.
std::string capture(const std::string& comment, const std::vector<std::pair<std::int64_t, CanFrame>>& frames,
                    const std::string& name = "base") {
    std::vector<std::uint8_t> bytes;
    REQUIRE(crspf::pcapng::append_section(bytes, comment));
    REQUIRE(crspf::pcapng::append_source(bytes, {.name = name, .description = {}, .link = LinkKind::kCan}));
    for (const auto& [ns, frame] : frames) {
        std::vector<std::uint8_t> record;
        REQUIRE(crspf::append_can_frame(record, frame));
        REQUIRE(crspf::pcapng::append_record(bytes, {.source = 0,
                                                     .link = LinkKind::kCan,
                                                     .direction = Direction::kReceived,
                                                     .cut = false,
                                                     .stamp = Stamp{ns},
                                                     .bytes = record}));
    }
    return {bytes.begin(), bytes.end()};
}

CanFrame frame(std::uint32_t id, std::uint8_t low) {
    CanFrame out;
    out.id = id;
    out.length = 2;
    out.data[0] = low;
    return out;
}

}  // namespace

TEST_CASE("run: recordings are played together, in the order of their stamps") {
    const Scratch scratch;
    const auto a = scratch.file("speed.log", line(100.0, "can0", "001#6400") + line(100.2, "can0", "001#C800"));
    const auto b = scratch.file("turn.log", line(100.1, "can0", "002#0A00") + line(100.3, "can0", "002#1400"));
    Run run = open_run({b, a}, parse_config(car(), "c"));
    REQUIRE(run.parts.size() == 1);
    const auto events = events_of(run);
    REQUIRE(events.size() == 2);
    CHECK(events[0].kind == LogEvent::Kind::kImu);
    CHECK(events[0].imu.stamp == Stamp{100'000'000});  // the first record is 0
    CHECK(events[0].recorded_stamp_s == Approx(100.1).epsilon(1e-12));
    CHECK(events[0].imu.speed_mps == Approx(1.0));
    CHECK(events[0].imu.yaw_rate_radps == Approx(0.010));
    CHECK(events[1].imu.speed_mps == Approx(2.0));
    CHECK(events[1].imu.yaw_rate_radps == Approx(0.020));
    CHECK(run.parts[0]->counts().odometry == 2);
    REQUIRE(run.parts[0]->sources().size() == 1);
    CHECK(text_of(run.parts[0]->sources()[0]) == "base: 4 records, samples 2");
}

TEST_CASE("run: a bus is known by its interface, and where it is the only one") {
    const Scratch scratch;
    const std::string both = line(1.0, "can0", "001#6400") + line(1.1, "can0", "002#0A00") +
                             line(1.2, "can1", "001#6400") + line(1.3, "can1", "002#1400");
    const auto two = scratch.file("two.log", both);
    Run run = open_run({two}, parse_config(car("can1"), "c"));
    auto events = events_of(run);
    REQUIRE(events.size() == 2);  // can0 is taken for ours as well: it is the only bus that is configured
    const auto other = scratch.file("other.log", line(1.0, "vcan7", "001#6400") + line(1.1, "vcan7", "002#0A00"));
    Run elsewhere = open_run({other}, parse_config(car("can1"), "c"));
    CHECK(events_of(elsewhere).size() == 1);
}

TEST_CASE("run: a clock that was set back is passed over, and counted") {
    const Scratch scratch;
    std::string text;
    for (int i = 0; i < 10; ++i) {
        const double stamp_s = i < 5 ? 1000.0 + 0.1 * i : 500.0 + 0.1 * i;
        text += line(stamp_s, "can0", "001#6400") + line(stamp_s + 0.05, "can0", "002#0A00");
    }
    Run run = open_run({scratch.file("set.log", text)}, parse_config(car(), "c"));
    const auto events = events_of(run);
    REQUIRE(events.size() == 10);
    for (std::size_t i = 1; i < events.size(); ++i) {
        const double step_s = (events[i].imu.stamp - events[i - 1].imu.stamp).seconds();
        CHECK(step_s > 0.04);
        CHECK(step_s < 0.11);
    }
    CHECK(run.parts[0]->counts().stamp_jumps == 1);
}

TEST_CASE("run: a recording's own configuration is used unless another is given") {
    const Scratch scratch;
    const std::string comment = print_config(parse_config(car() + "[lidar]\nx_m = 0.25\n", "c"));
    const auto file =
        scratch.file("run.pcapng", capture(comment, {{1'000'000'000, frame(1, 100)}, {1'100'000'000, frame(2, 10)}}));
    Run own = open_run({file}, std::nullopt);
    CHECK(own.config.slam.lidar.P_base_lidar.x_m == 0.25);
    CHECK(events_of(own).size() == 1);
    Run given = open_run({file}, parse_config(car(), "c"));
    CHECK(given.config.slam.lidar.P_base_lidar.x_m == 0.0);
    CHECK(events_of(given).size() == 1);

    // One that a writer of another kind left is none.
    const auto foreign = scratch.file("foreign.pcapng", capture("by hand", {{1, frame(1, 1)}}));
    CHECK(error_of({foreign}, std::nullopt).find("no source is configured") != std::string::npos);
    const auto spoilt = scratch.file("spoilt.pcapng", capture("[source.base]\ndriver = 3", {{1, frame(1, 1)}}));
    CHECK(error_of({spoilt}, std::nullopt).find("spoilt.pcapng (its configuration):2:10: ") != std::string::npos);
}

TEST_CASE("run: what cannot be played says why") {
    const Scratch scratch;
    const auto can = scratch.file("a.log", line(1.0, "can0", "001#6400"));
    const auto carmen = scratch.file("a.clf", "ODOM 0 0 0 0 0 0 1.0 host 1.0\n");
    CHECK(error_of({can, carmen}, parse_config(car(), "c")).find("a.clf: no recording of sensors") !=
          std::string::npos);
    const std::string urg = "[source.front]\ndriver = \"scip\"\nport = \"/dev/a\"\n";
    CHECK(error_of({can}, parse_config(urg, "c")).find("none of the configured sources speaks in it") !=
          std::string::npos);
    CHECK(error_of({scratch / "none.log"}, std::nullopt).find("none.log") != std::string::npos);
}

TEST_CASE("run: a damaged frame is counted, with its place, and the others are played") {
    const Scratch scratch;
    std::string bytes =
        capture("", {{1'000'000'000, frame(1, 100)}, {1'050'000'000, frame(1, 50)}, {1'100'000'000, frame(2, 10)}});
    const std::size_t second = bytes.rfind(std::string("\x00\x00\x00\x01\x02", 5));
    REQUIRE(second != std::string::npos);
    bytes[second + 4] = '\x7F';  // longer than its record
    Run run = open_run({scratch.file("damaged.pcapng", bytes)}, parse_config(car(), "c"));
    CHECK(events_of(run).size() == 1);
    CHECK(run.parts[0]->counts().damaged_lines == 1);
    CHECK(run.parts[0]->counts().first_damage.find("damaged.pcapng: record 2: a frame whose headers") !=
          std::string::npos);
}

TEST_CASE("run: the real VLP-16 recording gives planar scans") {
    const auto pcap = crspf::test::recording("velodyne/mrpt_sample_velodyne_vlp16_gps.pcap");
    CRSPF_NEED_RECORDING(pcap);
    const std::string lidar = "[source.lidar]\ndriver = \"velodyne\"\nport = \"udp://:2368\"\naddress = \"";
    Run run = open_run({pcap}, parse_config(lidar + "10.0.0.100\"\n", "c"));
    const auto events = events_of(run);
    REQUIRE(events.size() == 3);  // 0.39 s at 10 Hz, begun within a revolution
    CHECK((events[1].scan.stamp - events[0].scan.stamp).seconds() == Approx(0.1).margin(0.001));
    CHECK(events[0].recorded_stamp_s == Approx(1453364282.8).margin(0.15));
    // Another sensor's datagrams are not believed.
    Run other = open_run({pcap}, parse_config(lidar + "10.0.0.101\"\n", "c"));
    CHECK(events_of(other).empty());
    CHECK(text_of(other.parts[0]->sources()[0]) == "lidar: 293 records, foreign 293");
}
