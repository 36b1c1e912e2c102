#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <cstdint>
#include <memory>

#include "drivers/velodyne/velodyne_assembler.hpp"
#include "drivers/velodyne/velodyne_scan.hpp"
#include "tests/unit/drivers/velodyne_stream.hpp"

using namespace crspf;
using test::VelodyneStream;

namespace {

constexpr std::uint32_t kSensor = 0xC0A801C9;

/// Distance to the walls of a room in which left and right, ahead and behind all differ; `angle_rad` counter-clockwise.
double room_m(double angle_rad) {
    const double c = std::cos(angle_rad);
    const double s = std::sin(angle_rad);
    const double x_m = c > 0.0 ? 8.0 / c : c < 0.0 ? -3.0 / c : 1e9;
    const double y_m = s > 0.0 ? 2.0 / s : s < 0.0 ? -5.0 / s : 1e9;
    return std::min(x_m, y_m);
}

struct Result {
    Scan scan;
    Stamp cloud_begin;
    std::uint32_t scans = 0;
};

template <typename Distance>
std::unique_ptr<Result> scan_of(VelodyneModel model, const VelodyneScanParams& params, Distance distance,
                                double cut_rad = M_PI, std::uint32_t drop = 0) {
    VelodyneStream stream(model);
    auto result = std::make_unique<Result>();
    const auto assembler = std::make_unique<VelodyneAssembler>(VelodyneParams{.model = model, .cut_rad = cut_rad});
    const auto scanner = std::make_unique<VelodyneScanner>(params, model, *nominal_calibration(model));
    const auto packets = static_cast<std::uint32_t>(2.3e5 / stream.period_us());
    for (std::uint32_t i = 0; i < packets; ++i) {
        const auto bytes = stream.next_bytes(distance);
        if (drop != 0 && i % drop == drop - 1) {
            continue;
        }
        const Stamp received{std::llround((stream.packet_us(i) + stream.period_us()) * 1e3)};
        assembler->on_data(bytes, kSensor, received, [&](const VelodyneCloud& cloud) {
            if (scanner->scan(cloud, cut_rad, result->scan)) {
                ++result->scans;
                result->cloud_begin = cloud.stamp[0];
            } else {
                CHECK(result->scan.count == 0);
            }
        });
    }
    return result;
}

}  // namespace

TEST_CASE("velodyne: a room is not mirrored, and every beam is where and when it says") {
    for (const VelodyneModel model :
         {VelodyneModel::kVlp16, VelodyneModel::kPuckHiRes, VelodyneModel::kHdl32e, VelodyneModel::kVlp32c}) {
        const auto calibration = *nominal_calibration(model);
        for (const double cut_rad : {M_PI, 0.0, -1.0}) {
            const auto result = scan_of(
                model, {},
                [&](double azimuth_rad, std::uint32_t laser, std::uint32_t) {
                    const VelodyneLaser& l = calibration[laser];
                    const double range_m = room_m(-(azimuth_rad - l.rotation_rad)) / std::cos(l.vertical_rad);
                    return std::lround(range_m / traits_of(model).distance_unit_m);
                },
                cut_rad);
            REQUIRE(result->scans >= 1);
            const Scan& scan = result->scan;
            REQUIRE(scan.count == 1800);
            CHECK(scan.angle_increment_rad > 0.0);
            CHECK(scan.time_per_beam_s < 0.0);
            std::uint32_t hits = 0;
            double worst_m = 0.0;
            double sum_m = 0.0;
            for (std::uint32_t i = 0; i < scan.count; ++i) {
                if (scan.beam[i] != Beam::kHit) {
                    continue;
                }
                ++hits;
                const double angle_rad = scan.angle_min_rad + i * scan.angle_increment_rad;
                const double error_m = std::abs(static_cast<double>(scan.range_m[i]) - room_m(angle_rad));
                worst_m = std::max(worst_m, error_m);
                sum_m += error_m;
            }
            INFO("model " << static_cast<int>(model) << " cut " << cut_rad << " worst " << worst_m);
            CHECK(hits > 1750);
            // A beam's middle and the column it took lie up to a tenth of a degree apart: on the wall that is seen most
            // aslant, at (8, 2), 58 mm.
            CHECK(worst_m < 0.06);
            CHECK(sum_m / hits < 0.006);
            // The sensor turns ten times a second.
            CHECK(scan.time_per_beam_s * 1800 == Approx(-0.1).margin(1e-5));
            // Beam 0 is the last: it is measured a turn after the revolution's begin, when this laser gets there.
            const double rotation_rad = calibration[most_level_laser(model, calibration)].rotation_rad;
            const double turn_s = 0.1 + rotation_rad / (10.0 * 2.0 * M_PI);
            CHECK((scan.stamp - result->cloud_begin).seconds() == Approx(turn_s).margin(2e-4));
            // Where the laser looks at the time of beam 100, by the simulated head's azimuth, is the beam's direction.
            const double at_s = static_cast<double>(scan.stamp.ns) * 1e-9 + 100 * scan.time_per_beam_s;
            const double beam_rad = scan.angle_min_rad + 100 * scan.angle_increment_rad;
            CHECK(std::remainder(rotation_rad - at_s * 10.0 * 2.0 * M_PI - beam_rad, 2.0 * M_PI) ==
                  Approx(0.0).margin(0.002));
        }
    }
}

TEST_CASE("velodyne: no return, lost columns and chosen rings in the scan") {
    const auto distance = [](double, std::uint32_t laser, std::uint32_t) { return laser == 1 ? 0 : 500 * (1 + laser); };
    const auto level = scan_of(VelodyneModel::kVlp16, {}, distance);
    CHECK(std::count(level->scan.beam.begin(), level->scan.beam.begin() + 1800, Beam::kNoReturn) > 1750);
    CHECK(std::count(level->scan.beam.begin(), level->scan.beam.begin() + 1800, Beam::kHit) == 0);

    const auto chosen = scan_of(VelodyneModel::kVlp16, {.beams = 900, .laser = 6}, distance);
    REQUIRE(chosen->scan.count == 900);
    CHECK(std::count(chosen->scan.beam.begin(), chosen->scan.beam.begin() + 900, Beam::kHit) == 900);
    CHECK(static_cast<double>(chosen->scan.range_m[400]) == Approx(7.0 * std::cos(9.0 * M_PI / 180.0)));

    const auto holes = scan_of(VelodyneModel::kVlp16, {.beams = 900, .laser = 6}, distance, M_PI, 20);
    REQUIRE(holes->scan.count == 900);
    const auto invalid = std::count(holes->scan.beam.begin(), holes->scan.beam.begin() + 900, Beam::kInvalid);
    CHECK(invalid >= 33);  // three to five packets, each of 4.8 degrees, 11 to 13 beams
    CHECK(invalid <= 65);
}
