#include <algorithm>
#include <array>
#include <catch2/catch.hpp>
#include <cmath>
#include <cstdint>
#include <memory>
#include <set>
#include <span>
#include <utility>
#include <vector>

#include "core/base/rng.hpp"
#include "drivers/velodyne/velodyne_assembler.hpp"
#include "tests/support/heap_guard.hpp"
#include "tests/unit/drivers/velodyne_stream.hpp"

using namespace crspf;
using test::Bytes;
using test::VelodyneStream;

namespace {

constexpr std::uint32_t kSensor = 0xC0A801C9;
constexpr std::int64_t kHostStart_ns = 1700000000123456789;
constexpr double kDelay_us = 200.0;

constexpr auto kWall = [](double, std::uint32_t, std::uint32_t) { return 2500; };

/// What a test wants to know of each revolution.
struct Revolution {
    std::uint32_t columns;
    std::uint32_t missing;
    bool complete;
    std::vector<bool> measured;
    std::vector<Stamp> stamp;
    std::vector<double> azimuth_rad;
    std::vector<Beam> beam;
};

struct Rig {
    explicit Rig(VelodyneModel model, bool dual = false, double turns_per_s = 10.0)
        : stream(model, dual, turns_per_s),
          assembler(std::make_unique<VelodyneAssembler>(VelodyneParams{.model = model})) {}

    /// The host's clock when the sensor's shows so much; it need not agree with the hour.
    [[nodiscard]] Stamp host(double sensor_us) const {
        return {kHostStart_ns + std::llround((sensor_us - origin_us) * 1e3)};
    }

    void deliver(const Bytes& bytes, std::uint32_t index, double more_delay_us = 0.0) {
        const double sent_us = stream.packet_us(index) + stream.period_us() + kDelay_us + more_delay_us;
        assembler->on_data(bytes, kSensor, host(sent_us), [&](const VelodyneCloud& c) {
            seen.push_back({c.columns, c.missing_columns, c.complete, {}, {}, {}, {}});
            Revolution& r = seen.back();
            r.measured.assign(c.measured.begin(), c.measured.begin() + c.columns);
            r.stamp.assign(c.stamp.begin(), c.stamp.begin() + c.columns);
            r.azimuth_rad.assign(c.azimuth_rad.begin(), c.azimuth_rad.begin() + c.columns);
            r.beam.assign(c.beam.begin(), c.beam.begin() + static_cast<std::ptrdiff_t>(c.at(c.columns, 0)));
        });
    }

    template <typename Distance>
    void run(std::uint32_t packets, Distance distance) {
        for (std::uint32_t i = 0; i < packets; ++i) {
            const std::uint32_t index = stream.packet_index;
            deliver(stream.next_bytes(distance), index);
        }
    }

    VelodyneStream stream;
    double origin_us = 0.0;
    std::unique_ptr<VelodyneAssembler> assembler;
    std::vector<Revolution> seen;
};

}  // namespace

TEST_CASE("velodyne: revolutions are cut behind and hold every column") {
    const std::pair<VelodyneModel, bool> cases[] = {{VelodyneModel::kVlp16, false},
                                                    {VelodyneModel::kVlp16, true},
                                                    {VelodyneModel::kPuckHiRes, false},
                                                    {VelodyneModel::kHdl32e, false},
                                                    {VelodyneModel::kHdl32e, true}};
    for (const auto& [model, dual] : cases) {
        Rig rig(model, dual);
        const double per_turn = 1e5 / traits_of(model).column_us;
        rig.run(static_cast<std::uint32_t>(5.2e5 / rig.stream.period_us()), kWall);
        REQUIRE(rig.seen.size() == 5);
        CHECK_FALSE(rig.seen[0].complete);  // began in the middle
        std::uint64_t columns = 0;
        for (std::size_t i = 1; i < rig.seen.size(); ++i) {
            const Revolution& r = rig.seen[i];
            CHECK(r.complete);
            CHECK(r.missing == 0);
            CHECK(std::abs(r.columns - per_turn) < 2.0);
            CHECK(r.azimuth_rad.front() == Approx(M_PI).margin(0.01));
            CHECK(r.azimuth_rad.back() == Approx(M_PI).margin(0.01));
            CHECK(r.azimuth_rad.front() >= M_PI);
            CHECK(r.azimuth_rad.back() < M_PI);
            columns += r.columns;
        }
        CHECK(std::abs(static_cast<double>(columns) - 4.0 * per_turn) < 2.0);
        const VelodyneCounters& n = rig.assembler->counters();
        CHECK(n.lost + n.late + n.breaks + n.full + n.foreign == 0);
    }
}

TEST_CASE("velodyne: a head that trembles at the cut does not end a revolution twice") {
    Rig rig(VelodyneModel::kVlp16);
    for (std::uint32_t i = 0; i < 400; ++i) {
        VelodynePacket p = rig.stream.next(kWall);
        for (std::uint32_t b = 1; b < kVelodyneBlocks; b += 2) {
            // Each second block a degree's 0.8 back: behind the one before it.
            p.blocks[b].azimuth_cdeg = static_cast<std::uint16_t>((p.blocks[b].azimuth_cdeg + 36000 - 80) % 36000);
        }
        rig.deliver(rig.stream.bytes(p), i);
    }
    CHECK(rig.assembler->counters().packets == 400);
    CHECK(rig.assembler->counters().breaks == 0);
    REQUIRE(rig.seen.size() == 5);
    for (std::size_t i = 1; i < rig.seen.size(); ++i) {
        CHECK(rig.seen[i].complete);
        CHECK(rig.seen[i].columns > 1790);
        CHECK(rig.seen[i].columns < 1830);
    }
}

TEST_CASE("velodyne: equal returns of a pair count once") {
    Rig rig(VelodyneModel::kVlp16, true);
    // Lasers 0 to 7 see two things, the others one.
    rig.run(500, [](double, std::uint32_t laser, std::uint32_t r) { return laser < 8 && r == 1 ? 1000 : 2500; });
    REQUIRE(rig.seen.size() > 2);
    const Revolution& r = rig.seen[1];
    std::array<std::uint32_t, 2> hits{};
    for (std::size_t i = 0; i < r.beam.size(); ++i) {
        hits[i / 16 % 2] += r.beam[i] == Beam::kHit ? 1U : 0U;
    }
    CHECK(hits[0] == r.columns * 16);
    CHECK(hits[1] == r.columns * 8);
}

TEST_CASE("velodyne: no return is no return") {
    Rig rig(VelodyneModel::kHdl32e);
    rig.run(500, [](double, std::uint32_t laser, std::uint32_t) { return laser == 3 ? 0 : 2500; });
    REQUIRE(rig.seen.size() > 1);
    for (std::size_t i = 0; i < rig.seen[1].beam.size(); ++i) {
        REQUIRE(rig.seen[1].beam[i] == (i % 32 == 3 ? Beam::kNoReturn : Beam::kHit));
    }
}

TEST_CASE("velodyne: one packet in a hundred is lost, and the cloud shows which") {
    for (const bool with_loss : {true, false}) {  // without: the control
        Rig rig(VelodyneModel::kVlp16);
        Rng rng(99);
        std::uint32_t dropped = 0;
        std::set<std::int64_t> dropped_columns;  // by stamp, in whole microseconds of the true time
        for (std::uint32_t i = 0; i < 3000; ++i) {
            const Bytes bytes = rig.stream.next_bytes(kWall);
            if (i > 2 && i < 2990 && rng.next() % 100 == 0 && with_loss) {
                ++dropped;
                for (std::uint32_t c = 0; c < 24; ++c) {
                    dropped_columns.insert(std::llround(rig.stream.packet_us(i) + 55.296 * c));
                }
                continue;
            }
            rig.deliver(bytes, i);
        }
        CHECK((dropped > 15) == with_loss);
        CHECK(rig.assembler->counters().lost == dropped);
        CHECK(rig.assembler->counters().breaks == 0);
        std::uint32_t missing = 0;
        std::uint32_t wrong = 0;
        double worst_us = 0.0;
        double worst_cdeg = 0.0;
        for (const Revolution& r : rig.seen) {
            missing += r.missing;
            for (std::uint32_t c = 0; c < r.columns; ++c) {
                // The host's stamp of this column, less the delay that nothing on the wire can tell.
                const double at_us = static_cast<double>(r.stamp[c].ns - kHostStart_ns) * 1e-3 - kDelay_us;
                const double n = std::round(at_us / 55.296);
                worst_us = std::max(worst_us, std::abs(at_us - n * 55.296));
                const double off_cdeg = std::remainder(r.azimuth_rad[c] * 18000.0 / M_PI - n * 55.296 * 0.36, 36000.0);
                worst_cdeg = std::max(worst_cdeg, std::abs(off_cdeg));
                const bool was_dropped = dropped_columns.contains(std::llround(n * 55.296));
                wrong += was_dropped == r.measured[c] ? 1U : 0U;
                const auto column = std::span<const Beam>(r.beam).subspan(std::size_t{16} * c, 16);
                const bool all_invalid =
                    std::all_of(column.begin(), column.end(), [](Beam b) { return b == Beam::kInvalid; });
                wrong += all_invalid == r.measured[c] ? 1U : 0U;
            }
        }
        CHECK(wrong == 0);
        CHECK((missing > 300) == with_loss);
        CHECK(worst_us < 25.0);   // half a column would be 27.6
        CHECK(worst_cdeg < 2.0);  // azimuths are whole hundredths of a degree
    }
}

TEST_CASE("velodyne: a gap of half a turn or more ends the revolution") {
    Rig rig(VelodyneModel::kVlp16);
    rig.run(120, kWall);
    const std::size_t before = rig.seen.size();
    for (std::uint32_t i = 0; i < 50; ++i) {
        static_cast<void>(rig.stream.next(kWall));
    }
    rig.run(1, kWall);
    REQUIRE(rig.seen.size() == before + 1);
    CHECK_FALSE(rig.seen.back().complete);
    CHECK(rig.assembler->counters().lost == 50);
    CHECK(rig.assembler->counters().breaks == 1);
    rig.run(200, kWall);
    CHECK(rig.seen.back().complete);
}

TEST_CASE("velodyne: stamps that jump without the head are a clock that was set, not lost packets") {
    for (const double step_us : {5e6, -5e6, 3000.0, 1.5e9}) {
        Rig rig(VelodyneModel::kVlp16);
        rig.stream.start_us = 100e6;
        rig.run(300, kWall);
        for (std::uint32_t i = 0; i < 300; ++i) {
            const std::uint32_t index = rig.stream.packet_index;
            VelodynePacket p = rig.stream.next(kWall);
            p.stamp_us = static_cast<std::uint32_t>(p.stamp_us + step_us);
            rig.deliver(rig.stream.bytes(p), index);
        }
        INFO(step_us);
        CHECK(rig.assembler->counters().breaks >= 1);
        CHECK(rig.assembler->counters().breaks <= 2);
        CHECK(rig.assembler->counters().lost <= 3);
        CHECK(rig.seen.back().complete);
        for (const Revolution& r : rig.seen) {
            CHECK(r.missing == 0);
        }
    }
}

TEST_CASE("velodyne: twice, overtaken and foreign datagrams stay out") {
    Rig rig(VelodyneModel::kVlp16);
    std::vector<Bytes> all;
    for (std::uint32_t i = 0; i < 400; ++i) {
        all.push_back(rig.stream.next_bytes(kWall));
    }
    for (std::uint32_t i = 0; i < 400; ++i) {
        rig.deliver(all[i], i);
        if (i == 100) {
            rig.deliver(all[i], i);
            rig.deliver(all[i - 3], i);
            rig.assembler->on_data(all[i + 1], kSensor + 1, rig.host(0), [](const VelodyneCloud&) { FAIL(); });
            CHECK_FALSE(rig.assembler->on_position(Bytes(512), kSensor + 1));
            CHECK(rig.assembler->on_position(Bytes(512), kSensor));
            Bytes bad(512);
            bad[0xCA] = 9;
            CHECK_FALSE(rig.assembler->on_position(bad, kSensor));
        }
    }
    const VelodyneCounters& n = rig.assembler->counters();
    CHECK(n.packets == 400);
    CHECK(n.late == 2);
    CHECK(n.foreign == 2);
    CHECK(n.positions == 1);
    CHECK(n.bad_position == 1);
    CHECK(n.lost == 0);
    CHECK(n.breaks == 0);
}

TEST_CASE("velodyne: damaged datagrams are counted by their reason") {
    Rig rig(VelodyneModel::kVlp16);
    const Bytes sound = rig.stream.next_bytes(kWall);
    const auto with = [&](std::size_t at, std::uint8_t value) {
        Bytes b = sound;
        b[at] = value;
        return b;
    };
    rig.deliver(Bytes(sound.begin(), sound.end() - 1), 0);
    rig.deliver(with(100, 0), 0);
    rig.deliver(with(103, 0xFF), 0);
    rig.deliver(with(103, 0x10), 0);  // a legal azimuth, but 41 degrees on
    rig.deliver(with(1203, 0xFF), 0);
    rig.deliver(with(1204, 0), 0);
    rig.deliver(with(1205, 0x21), 0);
    const VelodyneCounters& n = rig.assembler->counters();
    CHECK(n.bad_length == 1);
    CHECK(n.bad_flag == 1);
    CHECK(n.bad_azimuth == 2);
    CHECK(n.bad_stamp == 1);
    CHECK(n.bad_mode == 1);
    CHECK(n.bad_model == 1);
    CHECK(n.packets == 0);
    rig.deliver(sound, 0);
    CHECK(n.packets == 1);
}

TEST_CASE("velodyne: stamps go on over the top of the hour, whatever the sensor's hour") {
    Rig rig(VelodyneModel::kHdl32e);
    rig.stream.start_us = 3.6e9 - 0.3e6;
    rig.origin_us = rig.stream.start_us;
    rig.run(1100, kWall);
    REQUIRE(rig.seen.size() >= 5);
    CHECK(rig.assembler->counters().breaks == 0);
    CHECK(rig.assembler->counters().lost == 0);
    CHECK(rig.assembler->clock().steps() == 0);
    std::int64_t before_ns = 0;
    double worst_us = 0.0;
    for (const Revolution& r : rig.seen) {
        for (std::uint32_t c = 0; c < r.columns; ++c) {
            if (before_ns != 0) {
                worst_us = std::max(worst_us, std::abs(static_cast<double>(r.stamp[c].ns - before_ns) * 1e-3 - 46.08));
            }
            before_ns = r.stamp[c].ns;
        }
    }
    CHECK(worst_us < 5.0);
}

TEST_CASE("velodyne: the hour is the host's") {
    constexpr std::int64_t kHour = 3600LL * 1000000000;
    CHECK(resolve_hour(0, {5 * kHour + 10}).ns == 5 * kHour);
    CHECK(resolve_hour(3599999999U, {5 * kHour + 10}).ns == 5 * kHour - 1000);
    CHECK(resolve_hour(10, {5 * kHour - 10}).ns == 5 * kHour + 10000);
    CHECK(resolve_hour(1799000000U, {5 * kHour}).ns == 5 * kHour + 1799000000000);
    CHECK(resolve_hour(1801000000U, {5 * kHour}).ns == 4 * kHour + 1801000000000);
    CHECK(resolve_hour(123, {-5 * kHour}).ns == -5 * kHour + 123000);
}

TEST_CASE("velodyne: waiting in the network does not shake the stamps") {
    VelodyneClock clock;
    Rng rng(4);
    double worst_us = 0.0;
    for (std::uint32_t i = 0; i < 20000; ++i) {
        const std::uint32_t stamp_us = 1000 * i;
        // The first three come late by far: the offset that they teach must not last.
        const double delay_us = i < 3 ? 9000.0 - 1000.0 * i : i % 10 == 0 ? 100.0 : 100.0 + rng.next() % 5000;
        // The sensor's quartz is 50 ppm slow.
        const Stamp received{kHostStart_ns + std::llround((stamp_us * 1.00005 + delay_us) * 1e3)};
        clock.observe(stamp_us, {0}, received);
        clock.adopt();
        if (i > 100) {
            const double truth_us = stamp_us * 1.00005 + 100.0;
            worst_us = std::max(worst_us,
                                std::abs(static_cast<double>(clock.at(stamp_us).ns - kHostStart_ns) * 1e-3 - truth_us));
        }
    }
    CHECK(worst_us < 3.0);
    CHECK(clock.steps() == 0);
    const Stamp restarted{kHostStart_ns + 60000000000};
    clock.observe(0, {0}, restarted);
    CHECK(clock.steps() == 1);
    CHECK(clock.at(0) == restarted);
}

TEST_CASE("velodyne: an HDL-64E is heard once it has told its calibration") {
    VelodyneCalibration unit{};
    for (std::uint32_t i = 0; i < kVelodyneLasers; ++i) {
        unit[i].vertical_rad = -0.4 + 0.007 * i;
        unit[i].rotation_rad = 0.1;
    }
    Rig rig(VelodyneModel::kHdl64eS2);
    for (std::uint32_t i = 0; i < kVelodyneStatusPackets + 1500; ++i) {
        VelodynePacket p = rig.stream.next(kWall);
        const VelodyneStatus status = status_of(unit, i);
        p.mode = status.type;
        p.product = status.value;
        rig.deliver(rig.stream.bytes(p), i);
    }
    const VelodyneCounters& n = rig.assembler->counters();
    CHECK(n.without_calibration >= 4096);
    CHECK(n.without_calibration <= kVelodyneStatusPackets);
    REQUIRE(rig.assembler->calibration());
    CHECK(rig.assembler->calibration()->at(63).vertical_rad == Approx(0.041).margin(1e-4));
    REQUIRE(rig.seen.size() >= 3);
    CHECK(rig.seen[1].complete);
    CHECK(rig.seen[1].columns == Approx(6 * 347.2).margin(7));
    CHECK(n.breaks == 0);
}

TEST_CASE("velodyne: what does not fit is given up and counted") {
    Rig rig(VelodyneModel::kVlp16, false, 1.0);  // ten times slower than the slowest
    rig.run(3200, kWall);
    CHECK(rig.assembler->counters().full >= 2);
    for (const Revolution& r : rig.seen) {
        CHECK_FALSE(r.complete);
        CHECK(r.columns <= capacity::kCloudColumns);
    }
}

TEST_CASE("velodyne: no heap") {
    if (!test::HeapGuard::available()) {
        WARN("skipped: a sanitizer owns malloc");
        return;
    }
    VelodyneStream stream(VelodyneModel::kVlp16);
    std::vector<Bytes> all;
    all.reserve(300);
    for (int i = 0; i < 300; ++i) {
        all.push_back(stream.next_bytes(kWall));
    }
    const auto assembler = std::make_unique<VelodyneAssembler>(VelodyneParams{});
    std::uint32_t revolutions = 0;
    const test::HeapGuard guard;
    for (std::uint32_t i = 0; i < all.size(); ++i) {
        assembler->on_data(all[i], kSensor, Stamp{i * 1327104LL}, [&](const VelodyneCloud&) { ++revolutions; });
    }
    const std::uint64_t calls = guard.calls();
    CHECK(calls == 0);
    CHECK(revolutions > 2);
    const test::HeapGuard control;
    std::vector<std::uint64_t> planted(1);
    static_cast<volatile std::uint64_t*>(planted.data())[0] = calls;  // or the allocation would be optimised away
    CHECK(control.calls() > 0);
}
