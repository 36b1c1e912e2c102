#include "platform/capture/carmen_line.hpp"

#include <algorithm>
#include <array>
#include <catch2/catch.hpp>
#include <memory>
#include <string>

#include "tests/support/heap_guard.hpp"

using Catch::Matchers::Contains;
using crspf::Beam;
using crspf::CarmenLine;
using crspf::kPi;
using crspf::LidarParams;
using crspf::Scan;
using Kind = crspf::CarmenLine::Kind;

namespace {

/// A line, read with `lidar`, and its scan.
struct Read {
    explicit Read(const std::string& text, const LidarParams& lidar = {})
        : line(crspf::parse_carmen_line(text, lidar, scan)) {}

    Scan scan;
    CarmenLine line;
};

std::string flaser(const std::string& count, const std::string& ranges) {
    return "FLASER " + count + " " + ranges + " 9 9 9 0.5 -0.25 0.125 976052857.337530 recon 0.000246";
}

std::string repeated(const std::string& field, std::size_t count) {
    std::string text;
    for (std::size_t i = 0; i < count; ++i) {
        text += field + " ";
    }
    return text;
}

const std::string kRobotLaser =
    "ROBOTLASER1 0 -1.0 3.14 0.5 20.0 0.010 0 4 1.5 2.5 30.0 0.01 2 7 8 9 9 9 0.5 -0.25 0.125 0 0 0.5 0.5 10.0 12.5 "
    "host 0.1";

}  // namespace

TEST_CASE("carmen: FLASER gives ranges, the robot's odometry and the ipc stamp") {
    const auto read = std::make_unique<Read>(flaser("4", "1.00 2.50 81.83 0.01"));
    CHECK(read->line.kind == Kind::kFrontLaser);
    CHECK(read->line.damage.empty());
    CHECK(read->line.stamp_s == 976052857.337530);
    CHECK(read->line.P_odom_base == crspf::Pose2{0.5, -0.25, 0.125});
    const Scan& scan = read->scan;
    CHECK(scan.count == 4);
    CHECK(scan.range_m[0] == 1.0F);
    CHECK(scan.range_m[1] == 2.5F);
    CHECK(scan.beam[1] == Beam::kHit);
    CHECK(scan.beam[2] == Beam::kNoReturn);
    CHECK(scan.beam[3] == Beam::kInvalid);
    CHECK(scan.stamp.ns == 0);
    CHECK(scan.time_per_beam_s == 0.0);
}

TEST_CASE("carmen: FLASER angles follow from the number of beams") {
    struct Case {
        std::size_t count;
        double increment_deg;
        double last_deg;
    };
    for (const Case& c : {Case{180, 1.0, 89.0}, Case{181, 1.0, 90.0}, Case{360, 0.5, 89.5}, Case{361, 0.5, 90.0}}) {
        const auto read = std::make_unique<Read>(flaser(std::to_string(c.count), repeated("1.0", c.count)));
        REQUIRE(read->line.kind == Kind::kFrontLaser);
        const Scan& scan = read->scan;
        CHECK(scan.angle_min_rad == Approx(crspf::radians(-90.0)));
        CHECK(scan.angle_increment_rad == Approx(crspf::radians(c.increment_deg)));
        CHECK(scan.angle_min_rad + (scan.count - 1) * scan.angle_increment_rad == Approx(crspf::radians(c.last_deg)));
    }
}

TEST_CASE("carmen: a single beam is a scan") {
    const auto read = std::make_unique<Read>(flaser("1", "2.0"));
    REQUIRE(read->line.kind == Kind::kFrontLaser);
    CHECK(read->scan.angle_increment_rad > 0.0);
}

TEST_CASE("carmen: a lidar that hangs upside down is turned round, in angle and in time") {
    LidarParams lidar;
    lidar.mount_inverted = true;
    lidar.time_per_beam_s = 0.001;
    const auto read = std::make_unique<Read>(flaser("4", "1 2 3 4"), lidar);
    const Scan& scan = read->scan;
    // Beam 3 of the sensor stood at -90 + 3 * 45 = 45 degrees to its left, which is 45 degrees to the right.
    CHECK(scan.angle_min_rad == Approx(-kPi / 4.0));
    CHECK(scan.angle_increment_rad == Approx(kPi / 4.0));
    CHECK(scan.range_m[0] == 4.0F);
    CHECK(scan.range_m[3] == 1.0F);
    CHECK(scan.angle_min_rad + 3.0 * scan.angle_increment_rad == Approx(kPi / 2.0));
    CHECK(scan.stamp.ns == 3'000'000);
    CHECK(scan.time_per_beam_s == -0.001);
}

TEST_CASE("carmen: readings that are no ranges are invalid beams, not damage") {
    const auto read = std::make_unique<Read>(flaser("8", "nan -nan -1 0 inf 1e30 1e999 -inf"));
    REQUIRE(read->line.kind == Kind::kFrontLaser);
    const Beam i = Beam::kInvalid;
    const Beam n = Beam::kNoReturn;
    const std::array<Beam, 8> expected{i, i, i, i, n, n, i, i};
    CHECK(std::equal(expected.begin(), expected.end(), read->scan.beam.begin()));
}

TEST_CASE("carmen: odometry that is not finite leaves the scan") {
    const auto read = std::make_unique<Read>("FLASER 1 1.0 9 9 9 0.5 nan 0.125 5.0 h 1.0");
    CHECK(read->line.kind == Kind::kFrontLaser);
    CHECK_FALSE(read->line.P_odom_base.has_value());
}

TEST_CASE("carmen: as many beams as a Scan holds, and one more") {
    const std::size_t most = crspf::capacity::kBeams;
    CHECK(std::make_unique<Read>(flaser(std::to_string(most), repeated("1", most)))->line.kind == Kind::kFrontLaser);
    const auto read = std::make_unique<Read>(flaser(std::to_string(most + 1), repeated("1", most + 1)));
    CHECK(read->line.kind == Kind::kDamaged);
    CHECK_THAT(read->line.damage, Contains("the 2048 of capacity::kBeams"));
}

TEST_CASE("carmen: ROBOTLASER1 brings its own angles and range, and the robot's pose") {
    const auto read = std::make_unique<Read>(kRobotLaser);
    REQUIRE(read->line.kind == Kind::kRobotLaser);
    CHECK(read->line.stamp_s == 12.5);
    CHECK(read->line.P_odom_base == crspf::Pose2{0.5, -0.25, 0.125});
    CHECK(read->scan.count == 4);
    CHECK(read->scan.angle_min_rad == -1.0);
    CHECK(read->scan.angle_increment_rad == 0.5);
    CHECK(read->scan.beam[1] == Beam::kHit);
    CHECK(read->scan.beam[2] == Beam::kNoReturn);  // 30 m, the sensor's own limit is 20 m
    CHECK(read->scan.beam[3] == Beam::kInvalid);
}

TEST_CASE("carmen: ROBOTLASER1's range limit never widens the configured one") {
    LidarParams lidar;
    lidar.range_max_m = 2.0;
    CHECK(std::make_unique<Read>(kRobotLaser, lidar)->scan.beam[1] == Beam::kNoReturn);
}

TEST_CASE("carmen: ODOM gives the pose") {
    const Read read("ODOM 1.0 2.0 -0.5 0.3 0.1 0.0 976052857.4 host 0.1");
    CHECK(read.line.kind == Kind::kOdometry);
    CHECK(read.line.P_odom_base == crspf::Pose2{1.0, 2.0, -0.5});
    CHECK(read.line.stamp_s == 976052857.4);
}

TEST_CASE("carmen: PARAM of the largest range") {
    for (const char* name : {"robot_front_laser_max", "laser_front_laser_max"}) {
        const Read read("PARAM " + std::string(name) + " 81.0 1.0 host 1.0");
        CHECK(read.line.kind == Kind::kRangeLimit);
        CHECK(read.line.range_limit_m == 81.0);
        CHECK(Read("PARAM " + std::string(name) + " on 1.0 host 1.0").line.kind == Kind::kDamaged);
        CHECK(Read("PARAM " + std::string(name) + " 0 1.0 host 1.0").line.kind == Kind::kDamaged);
        CHECK(Read("PARAM " + std::string(name) + " nan 1.0 host 1.0").line.kind == Kind::kDamaged);
    }
    CHECK(Read("PARAM robot_width 0.5 1.0 host 1.0").line.kind == Kind::kIgnored);
}

TEST_CASE("carmen: messages that are not ours, comments and empty lines are ignored") {
    for (const char* text : {"", "  ", "\r", "# FLASER 3", "#x", "RLASER 2 1 2 0 0 0 0 0 0 1 h 1", "SYNC tag 1 h 1",
                             "TRUEPOS 0 0 0 0 0 0 1 h 1", "RAWLASER1 x", "FLASER2 x", "NMEAGGA 1"}) {
        INFO(text);
        CHECK(Read(text).line.kind == Kind::kIgnored);
    }
}

TEST_CASE("carmen: a line of ours that does not hold together is damaged, with the reason") {
    struct Case {
        std::string text;
        const char* reason;
    };
    const std::string tail = " 0 0 0 0 0 0 1 h 1";
    for (const Case& c : {
             Case{"FLASER", "number of readings"},
             Case{"FLASER x", "number of readings"},
             Case{"FLASER -1" + tail, "number of readings"},
             Case{"FLASER 2.5 1 2" + tail, "number of readings"},
             Case{"FLASER 99999999999 1 2" + tail, "number of readings"},
             Case{"FLASER 0" + tail, "without beams"},
             Case{"FLASER 3 1.0 2.0", "reading 3 of 3"},
             Case{"FLASER 3 1.0 2.0x 3.0" + tail, "reading 2 of 3"},
             Case{"FLASER 2 1 2 0 0 0 0 0", "behind the readings"},
             Case{"FLASER 2 1 2 0 0 0 0 0 0 1 h", "behind the readings"},
             Case{"FLASER 2 1 2 0 0 0 0 0 0 inf h 1", "behind the readings"},
             Case{"FLASER 2 1 2 3" + tail, "behind the readings"},
             Case{"ODOM 1 2", "ODOM"},
             Case{"ODOM 1 2 3 4 5 6 7 h 9 10", "ODOM"},
             Case{"ROBOTLASER1 0 -1 3 0.5", "configuration"},
             Case{"ROBOTLASER1 0 -1 3 0 20 0 0 1 1 0 0 0 0 0 0 0 0 0 0 0 0 1 h 1", "full turn"},
             Case{"ROBOTLASER1 0 nan 3 1 20 0 0 1 1 0 0 0 0 0 0 0 0 0 0 0 0 1 h 1", "full turn"},
             Case{"ROBOTLASER1 0 0 3 7 20 0 0 2 1 1 0 0 0 0 0 0 0 0 0 0 0 0 1 h 1", "full turn"},
             Case{"ROBOTLASER1 0 0 3 1 20 0 0 1 1 4000000000 1 2", "remission"},
             Case{"ROBOTLASER1 0 0 3 1 20 0 0 1 1 0 1 2", "behind the readings"},
             Case{"\xff\xfe", "not a line"},
             Case{"1.5 2", "not a line"},
             Case{"FLASER,3", "not a line"},
         }) {
        INFO(c.text);
        const auto read = std::make_unique<Read>(c.text);
        CHECK(read->line.kind == Kind::kDamaged);
        CHECK_THAT(read->line.damage, Contains(c.reason));
    }
}

TEST_CASE("carmen: every cut of a line is damaged or the line's own number cut, never a crash") {
    for (const std::string& text : {flaser("4", "1.00 2.50 81.83 0.01"), kRobotLaser}) {
        const std::size_t last_blank = text.rfind(' ');
        for (std::size_t length = 1; length <= last_blank; ++length) {
            INFO(text.substr(0, length));
            const auto read = std::make_unique<Read>(text.substr(0, length));
            // A cut message name may be another's.
            CHECK((read->line.kind == Kind::kDamaged || (length < 12 && read->line.kind == Kind::kIgnored)));
        }
    }
}

TEST_CASE("carmen: a good line costs no heap call") {
    if (!crspf::test::HeapGuard::available()) {
        WARN("skipped: a sanitizer owns malloc in this build, heap calls cannot be counted");
        return;
    }
    const std::string text = flaser("180", repeated("1.07", 180));
    const auto scan = std::make_unique<Scan>();
    const crspf::test::HeapGuard guard;
    const bool good = crspf::parse_carmen_line(text, {}, *scan).kind == Kind::kFrontLaser;
    const auto calls = guard.calls();
    CHECK(good);
    CHECK(calls == 0);
}

TEST_CASE("carmen: its lines are recognised by their names") {
    CHECK(crspf::looks_like_carmen("FLASER 180 1.0"));
    CHECK(crspf::looks_like_carmen("PARAM robot_width 1"));
    CHECK_FALSE(crspf::looks_like_carmen("# FLASER 180"));
    CHECK_FALSE(crspf::looks_like_carmen("FLASERS 180"));
    CHECK_FALSE(crspf::looks_like_carmen("12 13"));
    CHECK_FALSE(crspf::looks_like_carmen(""));
}
