#include <algorithm>
#include <array>
#include <catch2/catch.hpp>
#include <cmath>
#include <cstdint>
#include <span>

#include "core/base/rng.hpp"
#include "drivers/velodyne/velodyne_geometry.hpp"
#include "tests/unit/drivers/velodyne_stream.hpp"

using namespace crspf;
using test::VelodyneStream;

namespace {

constexpr auto kNothing = [](double, std::uint32_t, std::uint32_t) { return 0; };

VelodynePacket with_azimuths(std::uint16_t first, std::uint16_t step) {
    VelodynePacket p;
    for (std::uint32_t b = 0; b < kVelodyneBlocks; ++b) {
        p.blocks[b].azimuth_cdeg = static_cast<std::uint16_t>((first + step * b) % 36000U);
    }
    p.mode = kVelodyneStrongest;
    return p;
}

struct Point {
    double x_m;
    double y_m;
    double z_m;
    int intensity;
};

/// One laser's return, placed among others that are not looked at.
Point place(VelodyneGeometry geometry, std::uint32_t laser, double azimuth_rad, double turn_rad_per_us,
            std::uint16_t distance, std::uint8_t reflectivity = 0) {
    const std::uint32_t first = laser / kVelodyneReturns * kVelodyneReturns;
    std::array<std::uint16_t, kVelodyneReturns> distances{};
    std::array<std::uint8_t, kVelodyneReturns> reflectivities{};
    std::array<float, kVelodyneReturns> x{};
    std::array<float, kVelodyneReturns> y{};
    std::array<float, kVelodyneReturns> z{};
    std::array<std::uint8_t, kVelodyneReturns> intensity{};
    distances[laser - first] = distance;
    reflectivities[laser - first] = reflectivity;
    geometry.aim(turn_rad_per_us);
    geometry.place(first, sin_cos(azimuth_rad), {distances, reflectivities}, {x, y, z, intensity});
    const auto at = laser - first;
    return {static_cast<double>(x[at]), static_cast<double>(y[at]), static_cast<double>(z[at]), intensity[at]};
}

/// Every correction of the geometry; some lasers are without the two-point calibration.
VelodyneCalibration some_unit(Rng& rng) {
    VelodyneCalibration calibration{};
    for (std::uint32_t i = 0; i < kVelodyneLasers; ++i) {
        calibration[i] = {.vertical_rad = 0.4 * rng.symmetric(),
                          .rotation_rad = 0.17 * rng.symmetric(),
                          .distance_m = 1.2 + 0.3 * rng.symmetric(),
                          .distance_x_m = i % 4 == 0 ? 0.0 : 1.2 + 0.3 * rng.symmetric(),
                          .distance_y_m = i % 5 == 0 ? 0.0 : 1.2 + 0.3 * rng.symmetric(),
                          .vertical_offset_m = 0.2 * rng.symmetric(),
                          .horizontal_offset_m = 0.026 * rng.symmetric()};
    }
    return calibration;
}

/// The manual's formulas for one unit, straight down, in the sensor's axes.
void reference_point(const VelodyneLaser& c, double azimuth_rad, double raw_m, double& x, double& y, double& z) {
    const double d = raw_m + c.distance_m;
    const double b = azimuth_rad - c.rotation_rad;
    const double w = c.vertical_rad;
    const double flat = d * std::cos(w) - c.vertical_offset_m * std::sin(w);
    const double xx = std::abs(flat * std::sin(b) - c.horizontal_offset_m * std::cos(b));
    const double yy = std::abs(flat * std::cos(b) + c.horizontal_offset_m * std::sin(b));
    double cx = 0.0;
    double cy = 0.0;
    if (c.distance_x_m != 0.0 && c.distance_y_m != 0.0) {
        cx = (c.distance_m - c.distance_x_m) * (xx - 2.4) / (25.04 - 2.4) + c.distance_x_m - c.distance_m;
        cy = (c.distance_m - c.distance_y_m) * (yy - 1.93) / (25.04 - 1.93) + c.distance_y_m - c.distance_m;
    }
    x = ((d + cx) * std::cos(w) - c.vertical_offset_m * std::sin(w)) * std::sin(b) -
        c.horizontal_offset_m * std::cos(b);
    y = ((d + cy) * std::cos(w) - c.vertical_offset_m * std::sin(w)) * std::cos(b) +
        c.horizontal_offset_m * std::sin(b);
    z = (d + cy) * std::sin(w) + c.vertical_offset_m * std::cos(w);
}

}  // namespace

TEST_CASE("velodyne: angles and rates of the models") {
    const auto vlp16 = *nominal_calibration(VelodyneModel::kVlp16);
    CHECK(vlp16[0].vertical_rad == Approx(-15.0 * M_PI / 180.0));
    CHECK(vlp16[1].vertical_rad == Approx(1.0 * M_PI / 180.0));
    CHECK(vlp16[14].vertical_rad == Approx(-1.0 * M_PI / 180.0));
    CHECK(most_level_laser(VelodyneModel::kVlp16, vlp16) == 1);
    const auto hdl32 = *nominal_calibration(VelodyneModel::kHdl32e);
    CHECK(hdl32[0].vertical_rad == Approx(-30.67 * M_PI / 180.0));
    CHECK(hdl32[31].vertical_rad == Approx(10.67 * M_PI / 180.0));
    CHECK(most_level_laser(VelodyneModel::kHdl32e, hdl32) == 15);
    CHECK(nominal_calibration(VelodyneModel::kPuckHiRes)->at(11).vertical_rad == Approx(7.3333 * M_PI / 180.0));
    CHECK_FALSE(nominal_calibration(VelodyneModel::kHdl64eS2));
    CHECK(1e6 / traits_of(VelodyneModel::kVlp16).packet_us == Approx(754).margin(1));
    const auto vlp32 = *nominal_calibration(VelodyneModel::kVlp32c);
    CHECK(most_level_laser(VelodyneModel::kVlp32c, vlp32) == 5);
    CHECK(1e6 / traits_of(VelodyneModel::kVlp32c).packet_us == Approx(1507).margin(1));
    CHECK(1e6 / traits_of(VelodyneModel::kHdl32e).packet_us == Approx(1808).margin(1));
    CHECK(1e6 / traits_of(VelodyneModel::kHdl64eS2).packet_us == Approx(3472.17).margin(0.01));
    CHECK(1e6 / traits_of(VelodyneModel::kHdl64eS3).packet_us == Approx(5787.03).margin(0.01));
    CHECK(model_of_product(0x22) == VelodyneModel::kVlp16);
    CHECK(model_of_product(0x24) == VelodyneModel::kPuckHiRes);
    CHECK(model_of_product(0x21) == VelodyneModel::kHdl32e);
    CHECK(model_of_product(0x28) == VelodyneModel::kVlp32c);
    CHECK_FALSE(model_of_product(0x23));  // VLP-32A and B: their angles are not published
}

TEST_CASE("velodyne: the time of each firing") {
    VelodyneColumns columns;
    REQUIRE(split(with_azimuths(100, 40), VelodyneModel::kVlp16, columns));
    REQUIRE(columns.count == 24);
    CHECK(columns.column[23].after_stamp_us == Approx(23 * 55.296));
    CHECK(columns.last_firing_us == Approx(23 * 55.296 + 15 * 2.304));
    CHECK(firing_us(VelodyneModel::kVlp16, 15) == Approx(34.56));

    // The HDL-32E is stamped at its last firing (manual, appendix E).
    REQUIRE(split(with_azimuths(100, 15), VelodyneModel::kHdl32e, columns));
    REQUIRE(columns.count == 12);
    CHECK(columns.column[0].after_stamp_us == Approx(-542.592));
    CHECK(columns.last_firing_us == Approx(0.0).margin(1e-9));

    VelodyneStream dual(VelodyneModel::kVlp16, true);
    REQUIRE(split(dual.next(kNothing), VelodyneModel::kVlp16, columns));
    CHECK(columns.count == 12);
    CHECK(columns.returns == 2);
    CHECK(columns.column[11].after_stamp_us == Approx(11 * 55.296));

    VelodyneStream banks(VelodyneModel::kHdl64eS2);
    REQUIRE(split(banks.next(kNothing), VelodyneModel::kHdl64eS2, columns));
    CHECK(columns.count == 6);
    CHECK(columns.column[5].after_stamp_us == Approx(5 * 23.296));
    CHECK(firing_us(VelodyneModel::kHdl64eS2, 32) == 0.0);  // the banks fire together
}

TEST_CASE("velodyne: azimuth between blocks, over the turn's end, and behind the last block") {
    VelodyneColumns columns;
    REQUIRE(split(with_azimuths(35900, 40), VelodyneModel::kVlp16, columns));
    CHECK(columns.column[0].azimuth_cdeg == 35900.0);
    CHECK(columns.column[1].azimuth_cdeg == Approx(35920.0));
    CHECK(columns.column[4].azimuth_cdeg == Approx(35980.0));
    CHECK(columns.column[5].azimuth_cdeg == Approx(0.0).margin(1e-9));
    CHECK(columns.column[22].azimuth_cdeg == Approx(340.0));
    CHECK(columns.column[23].azimuth_cdeg == Approx(360.0));
    CHECK(columns.turn_cdeg_per_us[23] * 110.592 == Approx(40.0));
    for (std::uint32_t c = 0; c < columns.count; ++c) {
        CHECK(columns.column[c].azimuth_cdeg >= 0.0);
        CHECK(columns.column[c].azimuth_cdeg < 36000.0);
    }
    CHECK_FALSE(split(with_azimuths(0, 201), VelodyneModel::kVlp16, columns));
    CHECK(split(with_azimuths(0, 200), VelodyneModel::kVlp16, columns));
    CHECK_FALSE(split(with_azimuths(0, 35949), VelodyneModel::kVlp16, columns));
    CHECK(split(with_azimuths(0, 35950), VelodyneModel::kVlp16, columns));
}

TEST_CASE("velodyne: axes") {
    VelodyneCalibration level{};
    const VelodyneGeometry geometry(VelodyneModel::kVlp16, level);
    const Point ahead = place(geometry, 0, 0.0, 0.0, 500);
    CHECK(ahead.x_m == Approx(1.0));
    CHECK(ahead.y_m == Approx(0.0).margin(1e-7));
    // A quarter of a turn clockwise from ahead is to the right, and right is negative.
    const Point right = place(geometry, 0, M_PI / 2.0, 0.0, 500);
    CHECK(right.x_m == Approx(0.0).margin(1e-7));
    CHECK(right.y_m == Approx(-1.0));
    // The last laser of a column fires 34.56 us later, and the head has turned on.
    const double turn_rad_per_us = 0.002;
    const Point late = place(geometry, 15, 1.0, turn_rad_per_us, 65535);
    CHECK(std::atan2(-late.y_m, late.x_m) == Approx(1.0 + 34.56 * turn_rad_per_us).margin(1e-7));
}

TEST_CASE("velodyne: the VLP-32C's unit, offsets and pairs") {
    const VelodyneModel model = VelodyneModel::kVlp32c;
    const auto calibration = *nominal_calibration(model);
    const VelodyneGeometry geometry(model, calibration);
    // Laser 0, straight ahead: 25 degrees down, and 1.4 degrees on, clockwise, hence to the right. 2500 units are 10 m:
    // 10 cos 25 cos 1.4 = 9.060372, -10 cos 25 sin 1.4 = -0.221431, -10 sin 25 = -4.226183.
    const Point down = place(geometry, 0, 0.0, 0.0, 2500);
    CHECK(down.x_m == Approx(9.060372).margin(2e-6));
    CHECK(down.y_m == Approx(-0.221431).margin(2e-6));
    CHECK(down.z_m == Approx(-4.226183).margin(2e-6));
    // Laser 1, to the right: 1 degree down and 4.2 back, to the front. 65535 units are 262.14 m:
    // 262.14 cos 1 sin 4.2 = 19.195737, -262.14 cos 1 cos 4.2 = -261.396199, -262.14 sin 1 = -4.574974.
    const Point right = place(geometry, 1, M_PI / 2.0, 0.0, 65535);
    CHECK(right.x_m == Approx(19.195737).margin(2e-5));
    CHECK(right.y_m == Approx(-261.396199).margin(2e-5));
    CHECK(right.z_m == Approx(-4.574974).margin(2e-6));
    // The last pair fires 15 x 2.304 us after the first.
    CHECK(firing_us(model, 1) == 0.0);
    CHECK(firing_us(model, 2) == Approx(2.304));
    CHECK(firing_us(model, 30) == Approx(34.56));
    CHECK(firing_us(model, 31) == Approx(34.56));
    // The manual's table 9-6 has 5, 11, 11 and 5 lasers in its columns of -4.2, -1.4, +1.4 and +4.2 degrees.
    std::array<int, 4> in_column{};
    for (std::uint32_t i = 0; i < 32; ++i) {
        const double column = (-calibration[i].rotation_rad * 180.0 / M_PI + 4.2) / 2.8;
        CHECK(std::abs(column - std::round(column)) < 1e-9);
        ++in_column.at(static_cast<std::size_t>(std::lround(column)));
    }
    CHECK(in_column == std::array<int, 4>{5, 11, 11, 5});
}

TEST_CASE("velodyne: aims that are kept are those that would be made anew") {
    Rng rng(4);
    VelodyneCalibration calibration = *nominal_calibration(VelodyneModel::kHdl32e);
    calibration[20].rotation_rad = 0.1;
    VelodyneGeometry kept(VelodyneModel::kHdl32e, calibration);
    std::array<std::uint16_t, kVelodyneReturns> distance{};
    distance.fill(40000);
    const std::array<std::uint8_t, kVelodyneReturns> reflectivity{};
    std::array<std::uint8_t, kVelodyneReturns> intensity{};
    std::array<float, kVelodyneReturns> x{};
    std::array<float, kVelodyneReturns> y{};
    std::array<float, kVelodyneReturns> z{};
    std::array<float, kVelodyneReturns> last_x{};
    std::uint64_t unequal = 0;
    std::uint64_t moved = 0;
    for (int n = 0; n < 2000; ++n) {
        // More speeds than are kept.
        const double speed = 1e-4 * (rng.next() % 7);
        kept.aim(speed);
        kept.place(0, sin_cos(1.0), {distance, reflectivity}, {x, y, z, intensity});
        const Point fresh = place(VelodyneGeometry(VelodyneModel::kHdl32e, calibration), 20, 1.0, speed, 40000);
        unequal += fresh.x_m == static_cast<double>(x[20]) && fresh.y_m == static_cast<double>(y[20]) &&
                           fresh.z_m == static_cast<double>(z[20])
                       ? 0U
                       : 1U;
        moved += x[20] == last_x[20] ? 0U : 1U;
        last_x = x;
    }
    CHECK(unequal == 0);
    CHECK(moved > 1000);  // the speed does matter
}

TEST_CASE("velodyne: the corrections of an HDL-64E") {
    Rng rng(64);
    const VelodyneCalibration calibration = some_unit(rng);
    const VelodyneGeometry geometry(VelodyneModel::kHdl64eS2, calibration);
    double worst_m = 0.0;
    double least_effect_m = 1e9;
    for (int n = 0; n < 20000; ++n) {
        const std::uint32_t laser = rng.next() % kVelodyneLasers;
        const double azimuth_rad = M_PI * (1.0 + rng.symmetric());
        const auto distance = static_cast<std::uint16_t>(500 + rng.next() % 50000);
        double x = 0.0;
        double y = 0.0;
        double z = 0.0;
        reference_point(calibration[laser], azimuth_rad, distance * 0.002, x, y, z);
        const Point p = place(geometry, laser, azimuth_rad, 0.0, distance);
        worst_m = std::max({worst_m, std::abs(p.x_m - y), std::abs(p.y_m + x), std::abs(p.z_m - z)});
        const double plain_x = distance * 0.002 * std::cos(calibration[laser].vertical_rad) * std::sin(azimuth_rad);
        const double plain_y = distance * 0.002 * std::cos(calibration[laser].vertical_rad) * std::cos(azimuth_rad);
        least_effect_m = std::min(least_effect_m, std::hypot(p.x_m - plain_y, p.y_m + plain_x));
    }
    CHECK(worst_m < 4e-6);        // half a step of a float at 100 m
    CHECK(least_effect_m > 0.1);  // the corrections do matter: without them the comparison would not hold
}

TEST_CASE("velodyne: every kernel gives the same bits") {
    Rng rng(7);
    VelodyneCalibration calibration = some_unit(rng);
    for (VelodyneLaser& laser : calibration) {
        laser.focal_distance_m = 12.0 + 4.0 * rng.symmetric();
        laser.focal_slope = 1.4;
    }
    struct Column {
        std::array<float, kVelodyneReturns> x{};
        std::array<float, kVelodyneReturns> y{};
        std::array<float, kVelodyneReturns> z{};
        std::array<std::uint8_t, kVelodyneReturns> intensity{};
        bool operator==(const Column&) const = default;
    };
    const auto model = GENERATE(VelodyneModel::kHdl64eS2, VelodyneModel::kVlp16);
    const std::uint32_t count = std::min(traits_of(model).lasers, kVelodyneReturns);
    VelodyneGeometry fastest(model, calibration);
    VelodyneGeometry portable(model, calibration, Kernel::kPortable);
    int unequal = 0;
    int equal_elsewhere = 0;
    for (int n = 0; n < 5000; ++n) {
        std::array<std::uint16_t, kVelodyneReturns> distance{};
        std::array<std::uint8_t, kVelodyneReturns> reflectivity{};
        for (std::uint32_t i = 0; i < count; ++i) {
            distance[i] = static_cast<std::uint16_t>(rng.next());
            reflectivity[i] = static_cast<std::uint8_t>(rng.next());
        }
        const double azimuth_rad = M_PI * (1.0 + rng.symmetric());
        const double turn_rad_per_us = 1e-4 * (rng.next() % 7);
        const auto place_all = [&](VelodyneGeometry& geometry, double at_rad) {
            Column out;
            geometry.aim(turn_rad_per_us);
            geometry.place(0, sin_cos(at_rad), {std::span(distance).first(count), std::span(reflectivity).first(count)},
                           {std::span(out.x).first(count), std::span(out.y).first(count), std::span(out.z).first(count),
                            std::span(out.intensity).first(count)});
            return out;
        };
        const Column expected = place_all(portable, azimuth_rad);
        unequal += place_all(fastest, azimuth_rad) == expected ? 0 : 1;
        equal_elsewhere += place_all(fastest, azimuth_rad + 1e-6) == expected ? 1 : 0;
    }
    CHECK(unequal == 0);
    CHECK(equal_elsewhere == 0);  // a millionth of a radian is seen
}

TEST_CASE("velodyne: the focal correction of the intensity") {
    VelodyneCalibration calibration{};
    const VelodyneGeometry plain(VelodyneModel::kHdl64eS2, calibration);
    CHECK(place(plain, 0, 0.0, 0.0, 30000, 77).intensity == 77);
    calibration[0].focal_distance_m = 13.1;
    calibration[0].focal_slope = 1.5;
    calibration[0].min_intensity = 40;
    calibration[0].max_intensity = 200;
    const VelodyneGeometry geometry(VelodyneModel::kHdl64eS2, calibration);
    const double expected = 50.0 + 1.5 * std::abs(256.0 * 0.9 * 0.9 - 256.0 * std::pow(1.0 - 10000.0 / 65535.0, 2.0));
    CHECK(place(geometry, 0, 0.0, 0.0, 10000, 50).intensity == static_cast<int>(expected));
    CHECK(place(geometry, 0, 0.0, 0.0, 65535, 100).intensity == 200);
    calibration[0].focal_slope = 0.0;
    CHECK(place(VelodyneGeometry(VelodyneModel::kHdl64eS2, calibration), 0, 0.0, 0.0, 10000, 3).intensity == 40);
}
