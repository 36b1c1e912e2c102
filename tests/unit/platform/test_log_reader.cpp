#include "platform/capture/log_reader.hpp"

#include <catch2/catch.hpp>
#include <memory>
#include <string>
#include <vector>

#include "platform/files/input_error.hpp"
#include "tests/support/heap_guard.hpp"
#include "tests/unit/platform/scratch.hpp"

using Catch::Matchers::Contains;
using crspf::LidarParams;
using crspf::LogCounts;
using crspf::LogEvent;
using crspf::open_log;
using crspf::test::compressed;
using crspf::test::Scratch;
using Kind = crspf::LogEvent::Kind;

namespace {

/// All events of a log, as pointers: they are large.
struct Run {
    std::vector<std::unique_ptr<LogEvent>> events;
    LogCounts counts;
    std::string format;

    [[nodiscard]] std::vector<Kind> kinds() const {
        std::vector<Kind> kinds;
        for (const auto& event : events) {
            kinds.push_back(event->kind);
        }
        return kinds;
    }
};

Run run(const std::filesystem::path& file, const LidarParams& lidar = {}) {
    Run result;
    const auto reader = open_log(file, lidar, {});
    result.format = reader->format();
    for (auto event = std::make_unique<LogEvent>(); reader->next(*event); event = std::make_unique<LogEvent>()) {
        result.events.push_back(std::move(event));
    }
    result.counts = reader->counts();
    return result;
}

std::string flaser(double x, double y, double theta, double stamp) {
    return "FLASER 4 1.0 2.0 3.0 4.0 9 9 9 " + std::to_string(x) + " " + std::to_string(y) + " " +
           std::to_string(theta) + " " + std::to_string(stamp) + " h 1.0\n";
}

std::string odom(double x, double y, double theta, double stamp) {
    return "ODOM " + std::to_string(x) + " " + std::to_string(y) + " " + std::to_string(theta) + " 0 0 0 " +
           std::to_string(stamp) + " h 1.0\n";
}

std::string dat(double stamp_us, int left, int right, int beams = 4) {
    std::string text = std::to_string(stamp_us) + " 0 " + std::to_string(left) + " " + std::to_string(right);
    for (int i = 4; i < 24; ++i) {
        text += " 0";
    }
    for (int i = 0; i < beams; ++i) {
        text += " 1500";
    }
    return text + "\n";
}

constexpr Kind kMotion = Kind::kMotion;
constexpr Kind kDifferential = Kind::kDifferential;
constexpr Kind kScan = Kind::kScan;

}  // namespace

TEST_CASE("log reader: a FLASER line gives the motion since the line before, then the scan, with one stamp") {
    const Scratch scratch;
    const Run r = run(scratch.file(
        "log", flaser(1.0, 1.0, crspf::kPi / 2.0, 100.0) + flaser(1.0, 1.5, crspf::kPi / 2.0 + 0.25, 100.25)));
    CHECK(r.format == "carmen");
    REQUIRE(r.kinds() == std::vector{kScan, kMotion, kScan});
    CHECK(r.events[0]->scan.stamp.ns == 0);
    CHECK(r.events[0]->recorded_stamp_s == 100.0);
    const crspf::MotionSample& motion = r.events[1]->motion;
    CHECK(motion.P_previous_base.x_m == Approx(0.5));
    CHECK(motion.P_previous_base.y_m == Approx(0.0).margin(1e-5));
    CHECK(motion.P_previous_base.theta_rad == Approx(0.25).margin(1e-5));
    CHECK(motion.stamp.ns == 250'000'000);
    CHECK(r.events[2]->scan.stamp.ns == 250'000'000);
    CHECK(r.events[2]->recorded_stamp_s == 100.25);
    CHECK(r.events[2]->scan.range_m[3] == 4.0F);
    CHECK(r.counts.lines == 2);
    CHECK(r.counts.scans == 2);
    CHECK(r.counts.odometry == 1);
    CHECK(r.counts.damaged_lines == 0);
}

TEST_CASE("log reader: odometry of ODOM and of the lasers is one chain") {
    const Scratch scratch;
    const Run r = run(scratch.file("log", odom(0, 0, 0, 1) + odom(1, 0, 0, 2) + flaser(3, 0, 0, 3) + odom(6, 0, 0, 4)));
    REQUIRE(r.kinds() == std::vector{kMotion, kMotion, kScan, kMotion});
    CHECK(r.events[0]->motion.P_previous_base.x_m == Approx(1.0));
    CHECK(r.events[1]->motion.P_previous_base.x_m == Approx(2.0));
    CHECK(r.events[3]->motion.P_previous_base.x_m == Approx(3.0));
}

TEST_CASE("log reader: the event may be another object for the scan than for its motion") {
    const Scratch scratch;
    const auto reader = open_log(scratch.file("log", flaser(0, 0, 0, 1) + flaser(1, 0, 0, 2)), {}, {});
    const auto a = std::make_unique<LogEvent>();
    const auto b = std::make_unique<LogEvent>();
    REQUIRE(reader->next(*a));
    REQUIRE(reader->next(*a));
    REQUIRE(a->kind == kMotion);
    REQUIRE(reader->next(*b));
    CHECK(b->kind == kScan);
    CHECK(b->scan.count == 4);
    CHECK_FALSE(reader->next(*a));
    CHECK_FALSE(reader->next(*a));
}

TEST_CASE("log reader: odometry that jumps or is not finite is dropped and counted, the scan stays") {
    const Scratch scratch;
    const auto file = scratch.file("log", flaser(0, 0, 0, 1) + flaser(500, 0, 0, 2) + flaser(501, 0, 0, 3) +
                                              "FLASER 1 1.0 9 9 9 nan 0 0 4.0 h 1.0\n" + flaser(502, 0, 0, 5));
    const Run r = run(file);
    REQUIRE(r.kinds() == std::vector{kScan, kScan, kMotion, kScan, kScan, kMotion, kScan});
    CHECK(r.events[2]->motion.P_previous_base.x_m == Approx(1.0));
    CHECK(r.events[5]->motion.P_previous_base.x_m == Approx(1.0));
    CHECK(r.counts.damaged_lines == 2);
    CHECK_THAT(r.counts.first_damage, Contains(file.string() + ":2: the odometry jumps by 500"));
}

TEST_CASE("log reader: damaged and foreign lines are counted and passed over") {
    const Scratch scratch;
    const auto file = scratch.file("log", "# comment\nPARAM robot_width 1 1 h 1\n" + flaser(0, 0, 0, 1) +
                                              "FLASER 0\n\x01\x02\xff\nRLASER 1\n" + std::string(2U << 20U, 'F') +
                                              "\n" + flaser(0, 0, 0, 2));
    const Run r = run(file);
    CHECK(r.counts.lines == 8);
    CHECK(r.counts.scans == 2);
    CHECK(r.counts.ignored_lines == 3);
    CHECK(r.counts.damaged_lines == 3);
    CHECK(r.counts.first_damage == file.string() + ":4: FLASER: a scan without beams");
}

TEST_CASE("log reader: PARAM lowers the limit of no return from there on, and never raises it") {
    const Scratch scratch;
    const Run r =
        run(scratch.file("log", flaser(0, 0, 0, 1) + "PARAM laser_front_laser_max 2.5 1 h 1\n" + flaser(0, 0, 0, 2) +
                                    "PARAM robot_front_laser_max 81.0 1 h 1\n" + flaser(0, 0, 0, 3)));
    CHECK(r.counts.no_return_beams == 4);
    CHECK(r.counts.ignored_lines == 0);
}

TEST_CASE("log reader: invalid and missing returns are counted, beam counts may change") {
    const Scratch scratch;
    const Run r = run(scratch.file("log", "FLASER 3 nan 99 1 9 9 9 0 0 0 1 h 1\n" + flaser(0, 0, 0, 2)));
    REQUIRE(r.kinds() == std::vector{kScan, kMotion, kScan});
    CHECK(r.counts.invalid_beams == 1);
    CHECK(r.counts.no_return_beams == 1);
    CHECK(r.events[0]->scan.count == 3);
    CHECK(r.events[2]->scan.count == 4);
}

TEST_CASE("log reader: stamps that jump are repaired and counted, and stay in recorded_stamp_s") {
    const Scratch scratch;
    const Run r = run(
        scratch.file("log", flaser(0, 0, 0, 10) + flaser(0, 0, 0, 10.5) + flaser(0, 0, 0, 9) + flaser(0, 0, 0, 9.25)));
    REQUIRE(r.events.size() == 7);
    CHECK(r.events[4]->scan.stamp.ns == 1'000'000'000);
    CHECK(r.events[4]->recorded_stamp_s == 9.0);
    CHECK(r.events[6]->scan.stamp.ns == 1'250'000'000);
    CHECK(r.counts.stamp_jumps == 1);
}

TEST_CASE("log reader: a laser line older than the odometry before it gives its scan, and no motion") {
    const Scratch scratch;
    const Run r =
        run(scratch.file("log", odom(0, 0, 0, 10) + odom(1, 0, 0, 10.5) + flaser(0.5, 0, 0, 10.25) + odom(2, 0, 0, 11) +
                                    flaser(3, 0, 0, 11.25) + odom(2.5, 0, 0, 11.125) + odom(4, 0, 0, 11.5)));
    REQUIRE(r.kinds() == std::vector{kMotion, kScan, kMotion, kMotion, kScan, kMotion});
    CHECK(r.events[1]->scan.stamp.ns == 250'000'000);
    CHECK(r.events[1]->recorded_stamp_s == 10.25);
    CHECK(r.events[2]->motion.P_previous_base.x_m == Approx(1.0));
    CHECK(r.events[3]->motion.stamp == r.events[4]->scan.stamp);
    CHECK(r.events[5]->motion.P_previous_base.x_m == Approx(1.0));  // nothing is lost
    CHECK(r.events[5]->motion.stamp.ns == 1'500'000'000);
    CHECK(r.counts.stamp_jumps == 0);
    CHECK(r.counts.damaged_lines == 0);
}

TEST_CASE("log reader: stamp_offset_s moves the scans, and neither odometry nor recorded stamps") {
    const Scratch scratch;
    LidarParams lidar;
    lidar.stamp_offset_s = -0.05;
    SECTION("CARMEN") {
        const Run r = run(scratch.file("log", flaser(0, 0, 0, 10) + flaser(0, 0, 0, 10.5)), lidar);
        REQUIRE(r.kinds() == std::vector{kScan, kMotion, kScan});
        CHECK(r.events[1]->motion.stamp.ns == 500'000'000);
        CHECK(r.events[2]->scan.stamp.ns == 450'000'000);
        CHECK(r.events[2]->recorded_stamp_s == 10.5);
        CHECK(r.counts.stamp_jumps == 0);
    }
    SECTION(".dat") {
        const Run r = run(scratch.file("log", dat(1e6, 0, 0) + dat(1.5e6, 0, 0)), lidar);
        REQUIRE(r.kinds() == std::vector{kScan, kDifferential, kScan});
        CHECK(r.events[1]->differential.stamp.ns == 500'000'000);
        CHECK(r.events[2]->scan.stamp.ns == 500'000'000 - 180'000'000 - 50'000'000);
        CHECK(r.events[2]->recorded_stamp_s == Approx(1.5));
    }
    SECTION("upside down, where the first beam measured is the last one") {
        lidar.mount_inverted = true;
        lidar.time_per_beam_s = 0.01;
        const Run r = run(scratch.file("log", flaser(0, 0, 0, 10) + flaser(0, 0, 0, 10.5)), lidar);
        REQUIRE(r.kinds() == std::vector{kScan, kMotion, kScan});
        CHECK(r.events[2]->scan.stamp.ns == 480'000'000);  // four beams: three steps
        CHECK(r.events[2]->scan.time_per_beam_s == -0.01);
    }
}

TEST_CASE("log reader: a .dat line gives the way of each wheel, then the scan") {
    const Scratch scratch;
    const Run r = run(scratch.file("log", dat(1e6, 100, 200) + dat(1.1e6, 1100, 200)));
    CHECK(r.format == "urg-dat");
    REQUIRE(r.kinds() == std::vector{kScan, kDifferential, kScan});
    CHECK(r.events[1]->differential.left_m == Approx(crspf::kPi * 0.077));
    CHECK(r.events[1]->differential.right_m == 0.0);
    CHECK(r.events[1]->differential.stamp.ns == 100'000'000);
    CHECK(r.events[2]->scan.stamp.ns == 100'000'000 - 180'000'000);  // older than the line it is written in
    CHECK(r.events[2]->recorded_stamp_s == Approx(1.1));
}

TEST_CASE("log reader: encoders that jump are dropped and counted, the scan stays") {
    const Scratch scratch;
    const Run r = run(scratch.file("log", dat(1e6, 65000, 0) + dat(2e6, -9000000, 0) + dat(3e6, -9000000, 10)));
    CHECK(r.kinds() == std::vector{kScan, kScan, kDifferential, kScan});
    CHECK(r.counts.damaged_lines == 1);
    CHECK_THAT(r.counts.first_damage, Contains(":2: the encoders jump"));
}

TEST_CASE("log reader: a .dat line that is cut off is damaged, a log that changes is followed") {
    const Scratch scratch;
    SECTION("one short line") {
        const Run r = run(scratch.file("log", dat(1e6, 0, 0) + dat(2e6, 0, 0, 3) + dat(3e6, 0, 0)));
        CHECK(r.counts.scans == 2);
        CHECK(r.counts.damaged_lines == 1);
    }
    SECTION("the first line") {
        const Run r = run(scratch.file("log", dat(1e6, 0, 0, 1) + dat(2e6, 0, 0) + dat(3e6, 0, 0) + dat(4e6, 0, 0)));
        CHECK(r.counts.scans == 3);
        CHECK(r.counts.damaged_lines == 1);
    }
    SECTION("from the middle on") {
        const Run r = run(scratch.file("log", dat(1e6, 0, 0) + dat(2e6, 0, 0, 9) + dat(3e6, 0, 0, 9)));
        CHECK(r.counts.scans == 2);
        CHECK(r.counts.damaged_lines == 1);
    }
}

TEST_CASE("log reader: every compression is read alike") {
    const Scratch scratch;
    std::string text;
    for (int i = 0; i < 500; ++i) {
        text += flaser(0.01 * i, 0, 0, i);
    }
    for (const char* filter : {"gzip", "bzip2", "xz", "zstd"}) {
        INFO(filter);
        CHECK(run(scratch.file(filter, compressed(text, filter))).counts.scans == 500);
    }
}

TEST_CASE("log reader: a compressed log cut short gives its scans, then an error") {
    const Scratch scratch;
    std::string text;
    for (int i = 0; i < 5000; ++i) {
        text += flaser(i * 7919 % 1000 * 0.001, i % 9, i % 7 * 0.1, i);
    }
    const std::string whole = compressed(text, "xz");
    const auto reader = open_log(scratch.file("log", whole.substr(0, whole.size() / 2)), {}, {});
    const auto event = std::make_unique<LogEvent>();
    CHECK_THROWS_WITH(
        [&] {
            while (reader->next(*event)) {
            }
        }(),
        Contains("log:") && Contains("cut short"));
    CHECK(reader->counts().scans > 0);
    CHECK(reader->counts().damaged_lines == 0);
    CHECK(reader->progress() > 0.0);
}

TEST_CASE("log reader: a plain log cut short loses its last line only") {
    const Scratch scratch;
    const std::string text = flaser(0, 0, 0, 1) + flaser(0, 0, 0, 2);
    const Run r = run(scratch.file("log", text.substr(0, text.size() - 20)));
    CHECK(r.counts.scans == 1);
    CHECK(r.counts.damaged_lines == 1);
}

TEST_CASE("log reader: what is no log is refused when it is opened") {
    const Scratch scratch;
    std::string garbage;
    for (int i = 0; i < 5000; ++i) {
        garbage += static_cast<char>(i * 37);
    }
    for (const std::string& content :
         {std::string("hello\n"), std::string("1 2 3 0 0 0 0 1\n"), std::string("\n\n\n"), garbage,
          std::string("# FLASER 3\n"), std::string(70000, '#') + "\n" + flaser(0, 0, 0, 1)}) {
        CHECK_THROWS_WITH(open_log(scratch.file("x", content), {}, {}), Contains("x: neither a CARMEN log"));
    }
    CHECK_THROWS_WITH(open_log(scratch.file("empty", ""), {}, {}), Contains("empty: empty"));
    CHECK_THROWS_WITH(open_log(scratch / "none", {}, {}), Contains("No such file"));
    CHECK_THROWS_AS(open_log("/dev/zero", {}, {}), crspf::InputError);
}

TEST_CASE("log reader: a line costs no heap call") {
    if (!crspf::test::HeapGuard::available()) {
        WARN("skipped: a sanitizer owns malloc in this build, heap calls cannot be counted");
        return;
    }
    const Scratch scratch;
    std::string text;
    for (int i = 0; i < 5000; ++i) {
        text += flaser(0.01 * i, 0, 0, i);
    }
    const auto reader = open_log(scratch.file("log", text), {}, {});
    const auto event = std::make_unique<LogEvent>();
    std::uint64_t scans = 0;
    const auto read_on = [&](std::uint64_t until) {
        while (scans < until && reader->next(*event)) {
            scans += event->kind == kScan ? 1U : 0U;
        }
    };
    read_on(2000);  // two blocks: all buffers have their size
    const crspf::test::HeapGuard guard;
    read_on(5000);
    const auto calls = guard.calls();
    CHECK(scans == 5000);
    CHECK(calls == 0);
}
