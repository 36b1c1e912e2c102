#include <catch2/catch.hpp>
#include <span>
#include <vector>

#include "tests/unit/sim/recorder.hpp"
#include "tools/sim/upright_view.hpp"

namespace crspf {

namespace {

using sim::Matter;
using sim::Sight;
using sim::UprightView;

constexpr double kWall_m = 2.5;
constexpr SinCos kAhead{.sin = 0.0, .cos = 1.0};
constexpr sim::Point kEye{1.0, 3.0};
constexpr double kEye_m = 1.2;

std::vector<Matter> matters(std::span<const Sight> sights) {
    std::vector<Matter> out;
    for (const Sight& sight : sights) {
        out.push_back(sight.face.matter);
    }
    return out;
}

void check_without_gaps(std::span<const Sight> sights) {
    CHECK(sights.front().low == -UprightView::kSteepest);
    CHECK(sights.back().high == UprightView::kSteepest);
    for (std::size_t i = 1; i < sights.size(); ++i) {
        CHECK(sights[i].low == sights[i - 1].high);
    }
}

}  // namespace

TEST_CASE("upright view: floor, wall, and a ceiling or the sky") {
    sim::Scene scene = test::room(10.0, 6.0);
    UprightView view(scene, kWall_m);
    const std::span<const Sight> indoors = view.look(kEye, kEye_m, kAhead, {});
    check_without_gaps(indoors);
    REQUIRE(matters(indoors) == std::vector{Matter::kFloor, Matter::kWall, Matter::kCeiling});
    CHECK(indoors[1].low == Approx(-kEye_m / 9.0));
    CHECK(indoors[1].high == Approx((kWall_m - kEye_m) / 9.0));
    CHECK(indoors[1].face.normal.x_m == -1.0);
    CHECK(indoors[0].face.way_m(-0.6) == Approx(2.0));

    scene.outdoors = true;
    CHECK(matters(view.look(kEye, kEye_m, kAhead, {})) == std::vector{Matter::kFloor, Matter::kWall, Matter::kSky});
}

TEST_CASE("upright view: who stands before the wall hides it up to his height") {
    const sim::Scene scene = test::room(10.0, 6.0);
    UprightView view(scene, kWall_m);
    const std::vector<sim::Circle> legs{{{5.0, 3.0}, 0.1}};
    const std::span<const Sight> seen = view.look(kEye, kEye_m, kAhead, {.legs = legs});
    check_without_gaps(seen);
    REQUIRE(matters(seen) == std::vector{Matter::kFloor, Matter::kPerson, Matter::kWall, Matter::kCeiling});
    CHECK(seen[1].low == Approx(-kEye_m / 3.9));
    CHECK(seen[1].high == Approx(0.5 / 3.9));
}

TEST_CASE("upright view: a car's bonnet is seen from above, its cabin standing on it") {
    const sim::Scene scene = test::room(20.0, 6.0);
    UprightView view(scene, kWall_m);
    const std::vector<sim::Box> car{
        {.centre = {6.0, 3.0}, .half_length_m = 2.0, .half_width_m = 0.9, .height_m = 0.9},
        {.centre = {6.5, 3.0}, .half_length_m = 1.0, .half_width_m = 0.75, .height_m = 1.5}};
    const std::span<const Sight> seen = view.look(kEye, kEye_m, kAhead, {.cars = car});
    check_without_gaps(seen);
    REQUIRE(matters(seen) ==
            std::vector{Matter::kFloor, Matter::kCar, Matter::kCar, Matter::kCar, Matter::kWall, Matter::kCeiling});
    CHECK(seen[1].face.upright);
    CHECK(seen[1].high == Approx(-0.3 / 3.0));  // the edge of the bonnet
    CHECK_FALSE(seen[2].face.upright);
    CHECK(seen[2].high == Approx(-0.3 / 4.5));  // the foot of the cabin, on the bonnet
    CHECK(seen[3].face.index == 1);
    CHECK(seen[3].high == Approx(0.3 / 4.5));
}

TEST_CASE("upright view: a crown is seen from the side and from below") {
    sim::Scene scene = test::room(20.0, 6.0);
    scene.outdoors = true;
    scene.crowns = {{.circle = {.centre = {5.0, 3.0}, .radius_m = 1.0}, .low_m = 2.2, .high_m = 6.0}};
    UprightView view(scene, kWall_m);
    const std::span<const Sight> seen = view.look(kEye, kEye_m, kAhead, {});
    check_without_gaps(seen);
    REQUIRE(matters(seen) ==
            std::vector{Matter::kFloor, Matter::kWall, Matter::kSky, Matter::kCrown, Matter::kCrown, Matter::kSky});
    CHECK(seen[3].low == Approx(1.0 / 5.0));  // its far end, from below
    CHECK_FALSE(seen[3].face.upright);
    CHECK(seen[4].low == Approx(1.0 / 3.0));
    CHECK(seen[4].high == Approx(4.8 / 3.0));
}

}  // namespace crspf
