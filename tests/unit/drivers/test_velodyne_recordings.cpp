#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <cstdint>
#include <ctime>
#include <iostream>
#include <memory>
#include <string>
#include <vector>

#include "drivers/velodyne/velodyne_assembler.hpp"
#include "drivers/velodyne/velodyne_scan.hpp"
#include "tests/unit/drivers/velodyne_pcap.hpp"
#include "tests/unit/drivers/velodyne_stream.hpp"
#include "tests/unit/eval/recordings.hpp"

using namespace crspf;

namespace {

struct Outcome {
    std::uint32_t complete = 0;
    std::uint32_t incomplete = 0;
    std::uint64_t hits = 0;
    std::uint64_t odd_steps = 0;  ///< from column to column, of stamp or azimuth
    std::vector<VelodynePosition> positions;
    std::vector<Scan> scans;
    std::unique_ptr<VelodyneAssembler> assembler;
};

Outcome replay(const std::vector<test::Datagram>& capture, VelodyneModel model) {
    Outcome out;
    out.assembler =
        std::make_unique<VelodyneAssembler>(VelodyneParams{.model = model, .source_address = capture.front().source});
    const auto scanner = std::make_unique<VelodyneScanner>(VelodyneScanParams{}, model, *nominal_calibration(model));
    for (const test::Datagram& d : capture) {
        if (d.port == 8308) {
            const auto position = out.assembler->on_position(d.payload, d.source);
            if (position) {
                out.positions.push_back(*position);
            }
            continue;
        }
        out.assembler->on_data(d.payload, d.source, d.received, [&](const VelodyneCloud& cloud) {
            (cloud.complete ? out.complete : out.incomplete) += 1;
            for (std::uint32_t c = 0; c < cloud.columns; ++c) {
                for (std::uint32_t laser = 0; laser < cloud.lasers; ++laser) {
                    out.hits += cloud.beam[cloud.at(c, laser)] == Beam::kHit ? 1U : 0U;
                }
                if (c > 0) {
                    const double us = static_cast<double>((cloud.stamp[c] - cloud.stamp[c - 1]).ns) * 1e-3;
                    const double turn = std::remainder(cloud.azimuth_rad[c] - cloud.azimuth_rad[c - 1], 2.0 * M_PI);
                    // Ten turns a second are 0.0628 rad a millisecond.
                    out.odd_steps +=
                        std::abs(us - traits_of(model).column_us) > 20.0 || turn < 0.0 || turn > 0.006 ? 1U : 0U;
                }
            }
            Scan scan;
            if (scanner->scan(cloud, VelodyneParams{}.cut_rad, scan)) {
                out.scans.push_back(scan);
            }
        });
    }
    return out;
}

void require_clean(const VelodyneCounters& n) {
    CHECK(n.foreign + n.bad_length + n.bad_flag + n.bad_azimuth + n.bad_stamp + n.bad_mode + n.bad_model == 0);
    CHECK(n.bad_position + n.late + n.lost + n.breaks + n.full + n.without_calibration == 0);
}

}  // namespace

TEST_CASE("velodyne: a real VLP-16 with GPS") {
    const auto file = test::recording("velodyne/mrpt_sample_velodyne_vlp16_gps.pcap");
    CRSPF_NEED_RECORDING(file);
    auto capture = test::read_capture(file);
    const Outcome out = replay(capture, VelodyneModel::kVlp16);
    require_clean(out.assembler->counters());
    CHECK(out.assembler->counters().packets == 293);
    CHECK(out.assembler->counters().positions == 57);
    CHECK(out.complete == 3);
    CHECK(out.odd_steps == 0);
    CHECK(out.hits > 30000);
    for (const VelodynePosition& p : out.positions) {
        CHECK(p.pps == VelodynePps::kLocked);
        CHECK(p.fix);
        CHECK(p.sentence.size() > 70);
    }
    for (const Scan& s : out.scans) {
        CHECK(s.time_per_beam_s * s.count == Approx(-0.1).margin(0.002));
        CHECK(std::count(s.beam.begin(), s.beam.begin() + s.count, Beam::kInvalid) <
              static_cast<std::ptrdiff_t>(s.count / 20));
    }

    SECTION("control: without one packet, and with a damaged one") {
        capture.erase(capture.begin() + 120);
        capture[200].payload[0] = 0;
        const Outcome damaged = replay(capture, VelodyneModel::kVlp16);
        CHECK(damaged.assembler->counters().bad_flag == 1);
        CHECK(damaged.assembler->counters().lost == 2);
        CHECK(damaged.assembler->counters().breaks == 0);
    }
    SECTION("control: the wrong model") {
        CHECK(replay(capture, VelodyneModel::kHdl32e).assembler->counters().bad_model == 293);
    }
}

TEST_CASE("velodyne: a real HDL-32E") {
    const auto file = test::recording("velodyne/mrpt_sample_velodyne_hdl32.pcap");
    CRSPF_NEED_RECORDING(file);
    const Outcome out = replay(test::read_capture(file), VelodyneModel::kHdl32e);
    require_clean(out.assembler->counters());
    CHECK(out.assembler->counters().packets == 500);
    CHECK(out.complete == 1);
    CHECK(out.odd_steps == 0);
    CHECK(out.hits > 50000);
    REQUIRE(out.scans.size() == 1);
}

// Not a test: asserts nothing, reads a clock. unit_velodyne "[speed]"
TEST_CASE("velodyne: packets a second", "[.][speed]") {
    struct Case {
        VelodyneModel model;
        const char* name;
        double real_per_s;
    };
    for (const Case& c : {Case{VelodyneModel::kVlp16, "VLP-16", 754}, Case{VelodyneModel::kHdl32e, "HDL-32E", 1808},
                          Case{VelodyneModel::kHdl64eS2, "HDL-64E S2", 3472}}) {
        test::VelodyneStream stream(c.model);
        VelodyneCalibration calibration = nominal_calibration(c.model).value_or(VelodyneCalibration{});
        if (is_hdl64e(c.model)) {
            for (VelodyneLaser& l : calibration) {
                l = {.vertical_rad = -0.1,
                     .rotation_rad = 0.05,
                     .distance_m = 1.2,
                     .distance_x_m = 1.3,
                     .distance_y_m = 1.1};
            }
        }
        std::vector<test::Bytes> all;
        all.reserve(2000);
        for (int i = 0; i < 2000; ++i) {
            all.push_back(stream.next_bytes([](double, std::uint32_t, std::uint32_t) { return 5000; }));
        }
        const auto assembler = std::make_unique<VelodyneAssembler>(VelodyneParams{.model = c.model}, calibration);
        std::uint64_t packets = 0;
        std::uint64_t columns = 0;
        const std::clock_t begin = std::clock();  // processor time: other programs may run beside
        std::int64_t received_ns = 0;
        for (int round = 0; round < 10; ++round) {
            for (const test::Bytes& bytes : all) {
                received_ns += std::llround(stream.period_us() * 1e3);
                assembler->on_data(bytes, VelodyneParams{}.source_address, {received_ns},
                                   [&](const VelodyneCloud& cloud) { columns += cloud.columns; });
                ++packets;
            }
        }
        const double s = static_cast<double>(std::clock() - begin) / CLOCKS_PER_SEC;
        std::cout << c.name << ": " << static_cast<double>(packets) / s << " packets/s, "
                  << static_cast<double>(packets) / s / c.real_per_s << " times the sensor's; " << columns
                  << " columns\n";
    }
}
