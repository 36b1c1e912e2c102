#include "platform/capture/urg_dat_line.hpp"

#include <algorithm>
#include <array>
#include <catch2/catch.hpp>
#include <memory>
#include <string>

using Catch::Matchers::Contains;
using crspf::Beam;
using crspf::LidarParams;
using crspf::Scan;
using crspf::UrgDatLine;

namespace {

struct Read {
    explicit Read(const std::string& text, const LidarParams& lidar = {})
        : line(crspf::parse_urg_dat_line(text, lidar, scan)) {}

    Scan scan;
    UrgDatLine line;
};

/// 25 fields as in the published logs, before the ranges.
const std::string kHead =
    "212387282 14710 29221 25178 0 0 0 170.1 9941 12750 8807 12749 475 255 0 0 255 0 0 178 61 126 255 0 0 ";
/// 24 fields.
const std::string kShortHead = kHead.substr(0, kHead.size() - 2);

std::string ranges(std::size_t count) {
    std::string text;
    for (std::size_t i = 0; i < count; ++i) {
        text.append(" ").append(std::to_string(1000 + i));
    }
    return text;
}

}  // namespace

TEST_CASE("urg dat: stamp, encoders and 682 ranges behind 24 or 25 other fields") {
    CHECK(std::make_unique<Read>(kShortHead + ranges(682))->scan.range_m[0] == 1.0F);
    const auto read = std::make_unique<Read>(kHead + ranges(682));
    REQUIRE(read->line.damage.empty());
    CHECK(read->line.stamp_s == Approx(212.387282));
    CHECK(read->line.left_counts == 29221.0);
    CHECK(read->line.right_counts == 25178.0);
    CHECK(read->line.fields == 707);
    CHECK(read->scan.count == 682);
    CHECK(read->scan.range_m[0] == 1.0F);
    CHECK(read->scan.range_m[681] == Approx(1.681F));
}

TEST_CASE("urg dat: the angles are the sensor's steps: 44 to 725 of 1024, 384 ahead") {
    const auto read = std::make_unique<Read>(kHead + ranges(682));
    const Scan& scan = read->scan;
    const double step = 2.0 * crspf::kPi / 1024.0;
    CHECK(scan.angle_increment_rad == Approx(step));
    CHECK(scan.angle_min_rad == Approx((44 - 384) * step));
    CHECK(scan.angle_min_rad + 340 * scan.angle_increment_rad == Approx(0.0).margin(1e-12));
    CHECK(scan.time_per_beam_s == Approx(0.1 / 1024.0));
    CHECK(scan.stamp.ns == -180'000'000);
}

TEST_CASE("urg dat: other numbers of beams share the same sector") {
    const auto read = std::make_unique<Read>(kShortHead + ranges(341));
    REQUIRE(read->line.damage.empty());
    const Scan& scan = read->scan;
    const double step = 2.0 * crspf::kPi / 1024.0;
    CHECK(scan.count == 341);
    CHECK(scan.range_m[0] == 1.0F);
    CHECK(scan.angle_increment_rad == Approx(2.0 * step));
    CHECK(scan.angle_min_rad == Approx((44.5 - 384) * step));  // between the two steps that it stands for
    CHECK(scan.time_per_beam_s == Approx(0.2 / 1024.0));
}

TEST_CASE("urg dat: error codes are invalid beams whatever the range limits, ranges are classified") {
    LidarParams lidar;
    lidar.range_min_m = 0.0;
    lidar.range_max_m = 4.0;
    const auto read = std::make_unique<Read>(kShortHead + " 0 7 19 20 3999 4000 -5 nan", lidar);
    REQUIRE(read->line.damage.empty());
    const std::array<Beam, 8> expected{Beam::kInvalid, Beam::kInvalid,  Beam::kInvalid, Beam::kHit,
                                       Beam::kHit,     Beam::kNoReturn, Beam::kInvalid, Beam::kInvalid};
    CHECK(std::equal(expected.begin(), expected.end(), read->scan.beam.begin()));
}

TEST_CASE("urg dat: the configured time per beam wins, upside down, time runs backwards") {
    LidarParams lidar;
    lidar.time_per_beam_s = 0.0001;
    CHECK(std::make_unique<Read>(kHead + ranges(682), lidar)->scan.time_per_beam_s == 0.0001);
    lidar.mount_inverted = true;
    const auto read = std::make_unique<Read>(kHead + ranges(682), lidar);
    CHECK(read->scan.time_per_beam_s == -0.0001);
    CHECK(read->scan.stamp.ns == -180'000'000 + 68'100'000);
    CHECK(read->scan.range_m[681] == 1.0F);
    CHECK(read->scan.angle_min_rad + 341 * read->scan.angle_increment_rad == Approx(0.0).margin(1e-12));
}

TEST_CASE("urg dat: a line that does not hold together is damaged, with the reason") {
    struct Case {
        std::string text;
        const char* reason;
    };
    for (const Case& c :
         {Case{"1 2 3", "3 fields"}, Case{kShortHead, "24 fields"}, Case{"x" + kHead + "5", "stamp"},
          Case{"inf" + kHead.substr(9) + "5", "stamp"}, Case{"1 2 nan 4" + kHead.substr(27) + "5", "stamp"},
          Case{kHead + "100 x 100", "range 3 of 4 is not a number"}}) {
        INFO(c.text);
        CHECK_THAT(std::make_unique<Read>(c.text)->line.damage, Contains(c.reason));
    }
}

TEST_CASE("urg dat: as many beams as a Scan holds, and one more") {
    const std::size_t most = crspf::capacity::kBeams;
    CHECK(std::make_unique<Read>(kShortHead + ranges(most))->scan.count == most);
    CHECK_THAT(std::make_unique<Read>(kShortHead + ranges(most + 1))->line.damage,
               Contains("the 2048 of capacity::kBeams"));
}

TEST_CASE("urg dat: its lines are recognised by 25 numbers, cut off or not") {
    CHECK(crspf::looks_like_urg_dat(kHead));
    CHECK(crspf::looks_like_urg_dat(kHead + "100 2"));
    CHECK_FALSE(crspf::looks_like_urg_dat(kShortHead));
    CHECK_FALSE(crspf::looks_like_urg_dat("FLASER " + kHead));
    CHECK_FALSE(crspf::looks_like_urg_dat(""));
}
