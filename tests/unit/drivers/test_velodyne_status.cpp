#include <catch2/catch.hpp>
#include <cmath>
#include <cstdint>
#include <optional>

#include "core/base/rng.hpp"
#include "core/base/trig.hpp"
#include "drivers/velodyne/velodyne_status.hpp"

using namespace crspf;

namespace {

VelodyneCalibration some_unit() {
    Rng rng(11);
    const auto whole = [&](int most) {
        return static_cast<double>(static_cast<int>(rng.next() % 2001U) - 1000) * most / 1000;
    };
    VelodyneCalibration calibration{};
    for (VelodyneLaser& l : calibration) {
        l = {.vertical_rad = radians(std::round(whole(2500)) * 0.01),
             .rotation_rad = radians(std::round(whole(900)) * 0.01),
             .distance_m = std::round(whole(1500)) * 0.001,
             .distance_x_m = std::round(whole(1500)) * 0.001,
             .distance_y_m = std::round(whole(1500)) * 0.001,
             .vertical_offset_m = std::round(whole(250)) * 0.001,
             .horizontal_offset_m = std::round(whole(26)) * 0.001,
             .focal_distance_m = std::round(whole(20000)) * 0.001,
             .focal_slope = std::round(whole(20)) * 0.1,
             .min_intensity = static_cast<std::uint8_t>(rng.next() % 40),
             .max_intensity = static_cast<std::uint8_t>(200 + rng.next() % 56)};
    }
    return calibration;
}

bool equal(const VelodyneCalibration& a, const VelodyneCalibration& b) {
    bool same = true;
    for (std::uint32_t i = 0; i < kVelodyneLasers; ++i) {
        const auto near = [](double u, double v) { return std::abs(u - v) < 1e-9; };
        same = same && near(a[i].vertical_rad, b[i].vertical_rad) && near(a[i].rotation_rad, b[i].rotation_rad) &&
               near(a[i].distance_m, b[i].distance_m) && near(a[i].distance_x_m, b[i].distance_x_m) &&
               near(a[i].distance_y_m, b[i].distance_y_m) && near(a[i].vertical_offset_m, b[i].vertical_offset_m) &&
               near(a[i].horizontal_offset_m, b[i].horizontal_offset_m) &&
               near(a[i].focal_distance_m, b[i].focal_distance_m) && near(a[i].focal_slope, b[i].focal_slope) &&
               a[i].min_intensity == b[i].min_intensity && a[i].max_intensity == b[i].max_intensity;
    }
    return same;
}

}  // namespace

TEST_CASE("velodyne: an HDL-64E tells its calibration, wherever one begins to listen") {
    const VelodyneCalibration unit = some_unit();
    for (const std::uint32_t start : {0U, 1U, 7U, 16U, 17U, 48U, 1000U, 4095U, 4100U, 4159U}) {
        VelodyneStatusListener listener;
        std::optional<VelodyneCalibration> heard;
        std::uint32_t packets = 0;
        while (!heard && packets < 3 * kVelodyneStatusPackets) {
            heard = listener.on_packet(status_of(unit, start + packets));
            ++packets;
        }
        INFO("from packet " << start << " after " << packets);
        REQUIRE(heard);
        CHECK(equal(*heard, unit));
        CHECK(packets <= 2 * kVelodyneStatusPackets);
        CHECK(packets >= 4096);
    }
    VelodyneCalibration other = unit;
    other[63].horizontal_offset_m += 0.001;
    CHECK_FALSE(equal(other, unit));
}

TEST_CASE("velodyne: a lost packet makes the listener begin again, never take a wrong byte") {
    const VelodyneCalibration unit = some_unit();
    for (const std::uint32_t lost : {5U, 9U, 15U, 2000U, 4000U}) {
        VelodyneStatusListener listener;
        std::optional<VelodyneCalibration> heard;
        for (std::uint32_t i = 0; i < 3 * kVelodyneStatusPackets && !heard; ++i) {
            if (i != lost) {
                heard = listener.on_packet(status_of(unit, i));
                CHECK((!heard || i >= kVelodyneStatusPackets));
            }
        }
        REQUIRE(heard);
        CHECK(equal(*heard, unit));
        CHECK(listener.restarts() == (lost < 16 ? 0 : 1));
    }
}
