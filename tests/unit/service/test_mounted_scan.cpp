#include <catch2/catch.hpp>
#include <memory>

#include "drivers/common/mounted_scan.hpp"

using crspf::Beam;
using crspf::LidarParams;
using crspf::mount;
using crspf::Scan;
using crspf::Stamp;

namespace {

std::unique_ptr<Scan> three_beams() {
    auto scan = std::make_unique<Scan>();
    scan->stamp = Stamp{1'000'000'000};
    scan->time_per_beam_s = 0.001;
    scan->angle_min_rad = -0.5;
    scan->angle_increment_rad = 0.25;
    scan->count = 3;
    scan->range_m[0] = 0.04F;
    scan->range_m[1] = 2.0F;
    scan->range_m[2] = 7.0F;
    scan->beam[0] = scan->beam[1] = scan->beam[2] = Beam::kHit;
    return scan;
}

}  // namespace

TEST_CASE("mounted scan: what is too near or too far is no hit") {
    const auto scan = three_beams();
    scan->beam[1] = Beam::kInvalid;
    LidarParams lidar;
    lidar.range_max_m = 5.0;
    lidar.stamp_offset_s = -0.5;
    mount(*scan, lidar);
    CHECK(scan->beam[0] == Beam::kInvalid);
    CHECK(scan->beam[1] == Beam::kInvalid);
    CHECK(scan->beam[2] == Beam::kNoReturn);
    CHECK(scan->stamp == Stamp{500'000'000});
    CHECK(scan->angle_min_rad == -0.5);
}

TEST_CASE("mounted scan: upside down, each beam keeps its own time, and left is right") {
    const auto scan = three_beams();
    LidarParams lidar;
    lidar.mount_inverted = true;
    mount(*scan, lidar);
    // The beam at +0 rad, measured last, looks to -0 rad now.
    CHECK(scan->angle_min_rad == Approx(0.0).margin(1e-15));
    CHECK(scan->angle_increment_rad == 0.25);
    CHECK(scan->range_m[0] == 7.0F);
    CHECK(scan->range_m[2] == 0.04F);
    CHECK(scan->beam[2] == Beam::kInvalid);
    CHECK(scan->stamp == Stamp{1'002'000'000});
    CHECK(scan->time_per_beam_s == -0.001);
    mount(*scan, lidar);  // twice upside down
    CHECK(scan->angle_min_rad == Approx(-0.5));
    CHECK(scan->stamp == Stamp{1'000'000'000});
}
