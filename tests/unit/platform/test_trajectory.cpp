#include "platform/files/trajectory.hpp"

#include <catch2/catch.hpp>
#include <cmath>
#include <string>

#include "platform/files/input_error.hpp"
#include "tests/unit/platform/scratch.hpp"

using Catch::Matchers::Contains;
using crspf::kPi;
using crspf::read_tum;
using crspf::TimedPose;
using crspf::write_tum;
using crspf::test::content_of;
using crspf::test::Scratch;

TEST_CASE("tum: a pose is written to the letter of the format") {
    const Scratch scratch;
    write_tum({{976052857.33753, {1.5, -2.25, kPi / 2.0}}}, scratch / "t");
    CHECK(content_of(scratch / "t") ==
          "976052857.337530 1.500000000 -2.250000000 0.000000000 0.000000000 0.000000000 0.707106781 0.707106781\n");
}

TEST_CASE("tum: what was written is read back") {
    const Scratch scratch;
    std::vector<TimedPose> poses;
    for (int i = -20; i < 20; ++i) {
        poses.push_back({1e9 + i * 0.1, {i * 1.234567, -i * 0.5, crspf::wrap_angle(i * kPi / 20.0)}});
    }
    write_tum(poses, scratch / "t");
    const std::vector<TimedPose> back = read_tum(scratch / "t");
    REQUIRE(back.size() == poses.size());
    for (std::size_t i = 0; i < poses.size(); ++i) {
        CHECK(std::abs(back[i].stamp_s - poses[i].stamp_s) < 1e-6);
        CHECK(std::abs(back[i].P_map_base.x_m - poses[i].P_map_base.x_m) < 1e-9);
        CHECK(std::abs(back[i].P_map_base.y_m - poses[i].P_map_base.y_m) < 1e-9);
        CHECK(std::abs(crspf::wrap_angle(back[i].P_map_base.theta_rad - poses[i].P_map_base.theta_rad)) < 1e-8);
    }
}

TEST_CASE("tum: an empty trajectory is an empty file") {
    const Scratch scratch;
    write_tum({}, scratch / "t");
    CHECK(content_of(scratch / "t").empty());
    CHECK(read_tum(scratch / "t").empty());
}

TEST_CASE("tum: comments, empty lines, Windows line ends and a missing last one are understood") {
    const Scratch scratch;
    const auto file = scratch.file("t", "# timestamp tx ty tz qx qy qz qw\r\n\r\n1 2 3 0 0 0 0 1\r\n2 2 3 0 0 0 0 1");
    CHECK(read_tum(file).size() == 2);
}

TEST_CASE("tum: the heading is that of a tilted quaternion, too") {
    const Scratch scratch;
    // Yaw 90 degrees, then pitch 20 degrees: q = qz(90) * qy(20).
    const double s = std::sqrt(0.5);
    const double half = 10.0 * kPi / 180.0;
    const std::string q = std::to_string(-s * std::sin(half)) + " " + std::to_string(s * std::sin(half)) + " " +
                          std::to_string(s * std::cos(half)) + " " + std::to_string(s * std::cos(half));
    const auto poses = read_tum(scratch.file("t", "1 0 0 0 " + q + "\n"));
    REQUIRE(poses.size() == 1);
    CHECK(poses[0].P_map_base.theta_rad == Approx(kPi / 2.0).margin(1e-5));
}

TEST_CASE("tum: anything else is refused with file and line") {
    const Scratch scratch;
    const std::string good = "1 2 3 0 0 0 0 1\n";
    for (const char* bad : {"1 2 3 0 0 0 0", "1 2 3 0 0 0 0 1 9", "1 2 x 0 0 0 0 1", "1 nan 3 0 0 0 0 1",
                            "inf 2 3 0 0 0 0 1", "1 2 3 0 0 0 0 0", "1 2 3 0 0 0 0 nan", "1,2,3,0,0,0,0,1", "hello"}) {
        INFO(bad);
        const auto file = scratch.file("t", good + bad + "\n");
        CHECK_THROWS_WITH(read_tum(file), Contains(file.string() + ":2: ") && Contains("; "));
    }
}

TEST_CASE("tum: a full disk is an error") {
    CHECK_THROWS_AS(write_tum({{1.0, {}}}, "/dev/full"), crspf::InputError);
}
