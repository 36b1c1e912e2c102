#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <memory>
#include <numbers>

#include "core/base/rng.hpp"
#include "drivers/sick/sick_scan.hpp"
#include "tests/unit/drivers/sick_examples.hpp"

using namespace crspf;
using namespace crspf::test;

namespace {

constexpr double kDegree = std::numbers::pi / 180.0;

std::unique_ptr<LmdScandata> quarter_circle() {
    auto data = std::make_unique<LmdScandata>();
    data->scan_frequency_centihertz = 5000;
    data->channels16 = 2;
    // Intensities first: the distances are found by name.
    data->channel[0] = channel({'R', 'S', 'S', 'I', '1'}, 100, 5, 0, 10000);
    data->channel[1] = channel({'D', 'I', 'S', 'T', '1'}, 0, 5, 900000, 10000);  // from straight ahead to the left
    data->values[0] = 1000;
    data->values[1] = 0;
    data->values[2] = 1;
    data->values[3] = 16;
    data->values[4] = 50000;
    return data;
}

struct Sequence {
    SickSequence sequence;
    std::unique_ptr<LmdScandata> data = std::make_unique<LmdScandata>();

    Sequence() { fill_tim(*data, 10); }
    std::optional<SickTiming> next(unsigned scans = 1) {
        data->telegram_counter = static_cast<std::uint16_t>(data->telegram_counter + scans);
        data->scan_counter = static_cast<std::uint16_t>(data->scan_counter + scans);
        data->start_us += scans * 66657;
        data->transmit_us = data->start_us + 6214;
        return sequence.accept(*data, Stamp{77});
    }
};

}  // namespace

TEST_CASE("sick scan: ranges, codes, angles and times") {
    const auto data = quarter_circle();
    auto scan = std::make_unique<Scan>();
    REQUIRE(fill_scan(*data, {}, Stamp{1'000'000'000}, *scan) == SickScanResult::kFilled);
    CHECK(scan->count == 5);
    CHECK(scan->stamp == Stamp{1'000'000'000});
    CHECK(scan->angle_min_rad == Approx(0.0).margin(1e-12));  // 90 degrees is straight ahead
    CHECK(scan->angle_increment_rad == Approx(kDegree));
    CHECK(scan->time_per_beam_s == Approx(1.0 / (50 * 360)));
    CHECK(scan->range_m[0] == 1.0F);
    CHECK(scan->beam[0] == Beam::kHit);
    CHECK(scan->beam[1] == Beam::kNoReturn);
    CHECK(scan->beam[2] == Beam::kInvalid);
    CHECK(scan->beam[3] == Beam::kInvalid);   // 16 mm is a range, nearer than range_min_m
    CHECK(scan->beam[4] == Beam::kNoReturn);  // 50 m, beyond range_max_m
}

TEST_CASE("sick scan: scale and offset") {
    const auto data = quarter_circle();
    data->channel[1].scale = 2.0F;
    data->channel[1].offset = 0.5F;
    auto scan = std::make_unique<Scan>();
    REQUIRE(fill_scan(*data, {}, Stamp{}, *scan) == SickScanResult::kFilled);
    CHECK(scan->range_m[0] == 2.5F);
}

TEST_CASE("sick scan: hanging, and steps the other way") {
    const auto data = quarter_circle();
    auto upright = std::make_unique<Scan>();
    auto scan = std::make_unique<Scan>();
    REQUIRE(fill_scan(*data, {}, Stamp{1'000'000'000}, *upright) == SickScanResult::kFilled);
    LidarParams hanging;
    hanging.mount_inverted = true;
    REQUIRE(fill_scan(*data, hanging, Stamp{1'000'000'000}, *scan) == SickScanResult::kFilled);
    CHECK(scan->angle_min_rad == Approx(-4 * kDegree));
    CHECK(scan->angle_increment_rad == Approx(kDegree));
    CHECK(scan->range_m[4] == 1.0F);
    CHECK(scan->time_per_beam_s == Approx(-upright->time_per_beam_s));
    CHECK((scan->stamp - upright->stamp).seconds() == Approx(4 * upright->time_per_beam_s).epsilon(1e-4));

    // The same beams, told from the left to straight ahead.
    data->channel[1].start_1e4deg = 940000;
    data->channel[1].step_1e4deg = -10000;
    std::reverse(data->values.begin(), data->values.begin() + 5);
    REQUIRE(fill_scan(*data, {}, Stamp{1'000'000'000}, *scan) == SickScanResult::kFilled);
    CHECK(scan->angle_min_rad == Approx(0.0).margin(1e-12));
    CHECK(scan->angle_increment_rad == Approx(kDegree));
    CHECK(scan->range_m == upright->range_m);
    CHECK(scan->beam == upright->beam);
    CHECK(scan->time_per_beam_s < 0.0);
}

TEST_CASE("sick scan: the TiM's times agree with its own beam frequency") {
    auto data = std::make_unique<LmdScandata>();
    fill_tim(*data);
    auto scan = std::make_unique<Scan>();
    REQUIRE(fill_scan(*data, {}, Stamp{}, *scan) == SickScanResult::kFilled);
    CHECK(scan->count == 811);
    CHECK(scan->angle_min_rad == Approx(-135 * kDegree));
    CHECK(1.0 / scan->time_per_beam_s == Approx(16200).epsilon(1e-3));
}

TEST_CASE("sick scan: what is no scan") {
    const auto data = quarter_circle();
    auto scan = std::make_unique<Scan>();
    data->channel[1].count = 2049;
    CHECK(fill_scan(*data, {}, Stamp{}, *scan) == SickScanResult::kTooMany);
    data->channel[1].count = 0;
    CHECK(fill_scan(*data, {}, Stamp{}, *scan) == SickScanResult::kNoDistances);
    data->channel[1].count = 5;
    data->channel[1].step_1e4deg = 0;
    CHECK(fill_scan(*data, {}, Stamp{}, *scan) == SickScanResult::kNoDistances);
    data->channel[1].step_1e4deg = 10000;
    data->channel[1].name[4] = '2';
    CHECK(fill_scan(*data, {}, Stamp{}, *scan) == SickScanResult::kNoDistances);
}

TEST_CASE("sick sequence: the first scan is withheld, then each has its times") {
    Sequence s;
    CHECK_FALSE(s.sequence.accept(*s.data, Stamp{}));
    const auto first = s.next();
    REQUIRE(first);
    CHECK(first->start_us == s.data->start_us);
    CHECK(first->transmit_us == first->start_us + 6214);
    CHECK(first->received == Stamp{77});
    CHECK(first->lost_before == 0);
    const auto later = s.next(4);
    REQUIRE(later);
    CHECK(later->lost_before == 3);
    CHECK(later->start_us - first->start_us == std::int64_t{4} * 66657);
    CHECK(s.sequence.counters().lost == 3);
    CHECK(s.sequence.counters().withheld == 1);
}

TEST_CASE("sick sequence: the clock and the counters wrap") {
    Sequence s;
    s.data->start_us = 0xFFFFFFFF - 200'000;
    s.data->telegram_counter = 0xFFFE;
    s.data->scan_counter = 0xFFFD;
    static_cast<void>(s.sequence.accept(*s.data, Stamp{}));
    std::uint64_t before = 0;
    for (int i = 0; i < 10; ++i) {
        const auto timing = s.next();
        REQUIRE(timing);
        if (before != 0) {
            CHECK(timing->start_us - before == 66657);
        }
        before = timing->start_us;
        CHECK(timing->clock_epoch == 1);
    }
    CHECK(before > 0xFFFFFFFFULL);
    CHECK(s.data->start_us < 1'000'000);  // control: it did wrap
}

TEST_CASE("sick sequence: one implausible telegram stays out and harms no other") {
    const auto spoil = GENERATE(0, 1, 2, 3, 4, 5);
    CAPTURE(spoil);
    Sequence s;
    s.next();
    REQUIRE(s.next());
    LmdScandata& data = *s.data;
    if (spoil != 0) {
        ++data.telegram_counter;
        ++data.scan_counter;
        data.start_us += 66657;
    }
    const auto sound = std::make_unique<LmdScandata>(data);
    switch (spoil) {
        case 0: break;                                   // the one before once more
        case 1: data.telegram_counter ^= 0x0400; break;  // too far on
        case 2: data.start_us ^= 0x00400000; break;      // 4 s off
        case 3: data.channel[0].start_1e4deg ^= 0x100; break;
        case 4: data.channel[0].scale = 2.0F; break;
        default: data.serial ^= 1;
    }
    CHECK_FALSE(s.sequence.accept(data, Stamp{}));
    data = *sound;
    CHECK(s.next());
}

TEST_CASE("sick sequence: a restarted or reconfigured sensor costs one scan") {
    Sequence s;
    s.next();
    REQUIRE(s.next());
    s.data->start_us = 1000;
    s.data->telegram_counter = 5;
    s.data->scan_counter = 5;
    s.data->channel[0].step_1e4deg = 5000;
    CHECK_FALSE(s.next());
    const auto timing = s.next();
    REQUIRE(timing);
    CHECK(timing->clock_epoch == 2);
    CHECK(timing->start_us == s.data->start_us);
}

TEST_CASE("sick scan: the sensor's clock is found on the host's line, late telegrams notwithstanding") {
    SickClock clock;
    Rng rng(3);
    constexpr double kDrift = 100e-6;
    constexpr double kFastest_s = 0.0001;
    double worst_s = 0.0;
    for (int i = 1; i < 1000; ++i) {
        const double start_s = 0.02 * i;  // on the host's line
        const double device_s = 5.0 + start_s * (1.0 + kDrift);
        SickTiming timing;
        timing.start_us = static_cast<std::uint64_t>(device_s * 1e6);
        timing.transmit_us = timing.start_us + 18'000;
        const double late_s = i % 10 == 0 ? 0.005 : 0.0003 * (1.0 + rng.symmetric());
        timing.received = Stamp{} + Duration::from_seconds(start_s + 0.018 + kFastest_s + late_s);
        const Stamp found = clock.beam0(timing);
        if (i > 200) {
            worst_s = std::max(worst_s, std::abs((found - Stamp{}).seconds() - start_s));
        }
    }
    CHECK(worst_s < 0.0005);

    // A restarted sensor begins at 0 again.
    SickTiming timing;
    timing.start_us = 0;
    timing.transmit_us = 18'000;
    timing.clock_epoch = 1;
    timing.received = Stamp{30'000'000'000};
    CHECK(clock.beam0(timing) == Stamp{29'982'000'000});
}
