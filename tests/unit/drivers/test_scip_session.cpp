#include <catch2/catch.hpp>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "tests/unit/drivers/scip_bench.hpp"

using namespace crspf;
using crspf::test::ScipBench;
using crspf::test::urg_04lx;

namespace {

std::unique_ptr<ScipBench> bench(const ScipDeviceParams& device, const ScipParams& params = {}) {
    return std::make_unique<ScipBench>(device, params);
}

// Scans within `seconds`, each of which must say what the sensor saw.
int scans(ScipBench& b, double seconds) {
    int n = 0;
    b.run(seconds, [&](const Scan& scan) {
        ++n;
        REQUIRE(scan.count == b.sensor.amax - b.sensor.amin + 1);
        for (std::uint32_t i = 0; i < scan.count; ++i) {
            REQUIRE(scan.range_m[i] == static_cast<float>(b.ranges[b.sensor.amin + i]) * 1e-3F);
        }
    });
    return n;
}

}  // namespace

TEST_CASE("scip session: from power-on to scans") {
    for (const bool scip1 : {false, true}) {
        for (const std::uint32_t baud : {0U, 19'200U, 250'000U}) {
            CAPTURE(scip1, baud);
            ScipParams params;
            params.baud = baud;
            const auto b = bench({urg_04lx(), scip1, 19'200}, params);
            CHECK(scans(*b, 2.0) >= 10);
            CHECK(b->session.streaming());
            CHECK(b->session.baud() == baud);
            CHECK(b->session.counters().failures == 0);
        }
    }
}

TEST_CASE("scip session: a sensor that streams already, one left in adjust mode") {
    const auto b = bench({urg_04lx(), false, 19'200});
    std::array<std::uint8_t, 64> reply{};
    ByteWriter out(reply);
    const std::array<std::uint8_t, 16> md{'M', 'D', '0', '0', '4', '4', '0', '7',
                                          '2', '5', '0', '1', '0', '0', '0', '\n'};
    b->device.on_bytes(md, {}, out);
    REQUIRE(b->device.streaming());
    CHECK(scans(*b, 2.0) >= 10);

    const auto c = bench({urg_04lx(), false, 19'200});
    const std::array<std::uint8_t, 4> tm0{'T', 'M', '0', '\n'};
    c->device.on_bytes(tm0, {}, out);
    CHECK(scans(*c, 2.0) >= 10);
    CHECK(c->session.counters().failures == 0);
}

TEST_CASE("scip session: two characters, clusters, intensities, skipped revolutions") {
    for (const ScipEncoding encoding :
         {ScipEncoding::kTwoChars, ScipEncoding::kThreeChars, ScipEncoding::kWithIntensity}) {
        ScipParams params;
        params.encoding = encoding;
        params.cluster = 3;
        params.skip = 1;
        const auto b = bench({urg_04lx(), false, 19'200}, params);
        int n = 0;
        b->run(3.0, [&](const Scan& scan) {
            ++n;
            REQUIRE(scan.count == 228);
            for (std::uint32_t i = 0; i < scan.count; ++i) {
                REQUIRE(scan.range_m[i] == static_cast<float>(b->ranges[44 + 3 * i]) * 1e-3F);
            }
        });
        CHECK(n >= 8);
        CHECK(n <= 15);
    }
}

TEST_CASE("scip session: unplugged and plugged in again") {
    const auto b = bench({urg_04lx(), true, 19'200});
    CHECK(scans(*b, 2.0) >= 10);
    b->plugged = false;
    CHECK(scans(*b, 0.301) == 0);
    CHECK(b->session.counters().silences == 1);  // three scan periods
    CHECK_FALSE(b->session.streaming());
    const int before = b->openings;
    CHECK(scans(*b, 60.0) == 0);
    CHECK(b->openings - before >= 28);  // never gives up
    CHECK(b->openings - before <= 40);  // and does not hammer
    b->plugged = true;
    b->device.power_on(b->device_time(b->now));
    CHECK(scans(*b, 4.0) >= 10);
}

TEST_CASE("scip session: silence, laser off, trouble, stuck time") {
    const auto b = bench({urg_04lx(), false, 19'200});
    CHECK(scans(*b, 2.0) >= 10);
    b->mute = true;
    CHECK(scans(*b, 0.35) == 0);
    CHECK(b->session.counters().silences == 1);
    b->mute = false;
    CHECK(scans(*b, 2.0) >= 8);

    b->device.switch_laser_off();
    CHECK(scans(*b, 1.0) >= 7);
    CHECK(b->session.counters().laser_off == 1);

    b->device.plant_status({'5', '5'});
    CHECK(scans(*b, 2.0) >= 8);
    CHECK(b->session.counters().trouble == 1);
    CHECK(std::string(b->session.last_trouble()) == "hardware trouble");
    CHECK(b->session.counters().failures == 2);
}

TEST_CASE("scip session: a sensor whose time stands still") {
    std::array<std::uint8_t, 4096> buffer{};
    const auto c = bench({urg_04lx(), false, 19'200});
    CHECK(scans(*c, 2.0) >= 10);
    const std::uint64_t before = c->session.listener().counters().scans;
    ByteWriter out(buffer);
    // The revolution that the bench would send next.
    c->device.on_revolution({c->now.ns / 100'000'000 * 100'000'000}, c->ranges, {}, out);
    for (int i = 0; i < 4; ++i) {
        c->session.on_bytes(out.written(), c->now + Duration{100'000'000}, [](const Scan&) {});
    }
    CHECK(c->session.listener().counters().scans == before + 1);
    CHECK(c->session.listener().counters().stuck_stamps == 3);
    CHECK(c->session.counters().failures == 1);
}

TEST_CASE("scip session: stamps of beam 0 within 1 ms, with 0.1 % of drift and 2 ms of jitter") {
    for (const double drift : {-1e-3, 0.0, 1e-3}) {
        ScipParams params;
        const auto b = bench({urg_04lx(), false, 19'200}, params);
        b->drift = drift;
        b->jitter_s = 2e-3;
        b->run(12.0);
        double squares = 0.0;
        double sum = 0.0;
        int n = 0;
        b->run(60.0, [&](const Scan& scan) {
            // The bench turns on the sensor's clock: beam 0 of the revolution before.
            const double step = static_cast<double>(b->period_ns()) / 1024.0;
            const std::int64_t device_ns = b->device_time(b->now).ns;
            const std::int64_t revolution = device_ns / b->period_ns() - 1;
            const double beam0_device = static_cast<double>(revolution * b->period_ns()) + 44.0 * step;
            const double error = static_cast<double>(scan.stamp.ns) - beam0_device / (1.0 + drift);
            squares += error * error;
            sum += error;
            ++n;
        });
        REQUIRE(n > 500);
        WARN("drift " << drift << ": rms " << std::sqrt(squares / n) * 1e-6 << " ms, mean " << sum / n * 1e-6 << " ms");
        CHECK(std::sqrt(squares / n) < 1e6);
        CHECK(b->session.listener().counters().clock_jumps == 0);
    }
}

TEST_CASE("scip session: who the sensor is, and how it says it is when it is in trouble") {
    const auto b = bench({urg_04lx(), false, 19'200});
    CHECK(scans(*b, 2.0) >= 10);
    CHECK(std::string(b->session.listener().sensor().model.data()) == "URG-04LX");
    CHECK(std::string(b->session.listener().identity().serial.data()) == "H0000000");
    CHECK(std::string(b->session.listener().identity().firmware.data()) == "3.1.00");
    CHECK(std::string(b->session.listener().identity().diagnosis.data()).empty());  // nobody had reason to ask
    b->device.plant_status({'5', '0'});
    CHECK(scans(*b, 2.0) >= 10);
    CHECK(b->session.counters().trouble == 1);
    CHECK(std::string(b->session.listener().identity().diagnosis.data()) == "Sensor works well.");
}

TEST_CASE("scip session: a senseless reply to PP in the middle of a stream costs an attempt, no more") {
    const auto b = bench({urg_04lx(), false, 19'200});
    CHECK(scans(*b, 2.0) >= 10);
    constexpr std::string_view kReply = "PP\n00P\n\n";
    const std::vector<std::uint8_t> bytes(kReply.begin(), kReply.end());
    b->session.on_bytes(bytes, b->now, [](const Scan&) { FAIL("no scan"); });
    CHECK(b->session.listener().sensor().ares == 0);
    CHECK(scans(*b, 2.0) >= 10);
    CHECK(b->session.counters().failures == 1);
}
