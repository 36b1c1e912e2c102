// A line that damages bytes: what is delivered all the same, and how much of it is wrong.
#include <catch2/catch.hpp>
#include <memory>

#include "tests/unit/drivers/scip_bench.hpp"

using namespace crspf;
using crspf::test::ScipBench;
using crspf::test::urg_04lx;

namespace {

// Each byte is changed, lost, or followed by another, with the same probability.
std::vector<std::uint8_t> damage(Bytes bytes, double probability, Rng& rng) {
    std::vector<std::uint8_t> out;
    for (const std::uint8_t c : bytes) {
        const auto noise = static_cast<std::uint8_t>(rng.next() >> 8U);
        if (0.5 * (1.0 + rng.symmetric()) >= probability) {
            out.push_back(c);
            continue;
        }
        switch (rng.next() % 3) {
            case 0: out.push_back(noise); break;
            case 1: break;
            default:
                out.push_back(c);
                out.push_back(noise);
                break;
        }
    }
    return out;
}

struct Outcome {
    int sent = 0;
    int whole = 0;              // reached the session undamaged
    int taken = 0;              // delivered
    int wrong = 0;              // delivered, and not what was sent
    std::uint64_t refused = 0;  // right check characters, refused by the further checks
};

Outcome run(int scans, double probability, std::uint32_t beams) {
    ScipSensor sensor = urg_04lx();
    sensor.amax = sensor.afrt + 1 + beams;
    sensor.amin = sensor.amax - beams + 1;
    sensor.afrt = sensor.amin + 1;
    const auto b = std::make_unique<ScipBench>(ScipDeviceParams{sensor, false, 19'200}, ScipParams{});
    b->run(2.0);
    REQUIRE(b->session.streaming());
    Rng rng(3);
    Outcome outcome;
    std::vector<std::uint32_t> sent(sensor.amax + 1);
    std::int64_t step0_ns = b->now.ns / 100'000'000 * 100'000'000;
    std::array<std::uint8_t, 8192> buffer{};
    for (int i = 0; i < scans; ++i) {
        step0_ns += 100'000'000;
        for (std::uint32_t& value : sent) {
            value = 20 + rng.next() % 5'500;
        }
        ByteWriter out(buffer);
        b->device.on_revolution({step0_ns}, sent, {}, out);
        const std::vector<std::uint8_t> received = damage(out.written(), probability, rng);
        const bool whole = std::equal(received.begin(), received.end(), out.written().begin(), out.written().end());
        const Stamp now{step0_ns + 80'000'000};
        ++outcome.sent;
        outcome.whole += whole ? 1 : 0;
        b->session.on_bytes(received, now, [&](const Scan& scan) {
            ++outcome.taken;
            bool same = scan.count == beams;
            for (std::uint32_t k = 0; same && k < beams; ++k) {
                same = b->session.listener().ranges().range_mm[k] == sent[sensor.amin + k];
            }
            outcome.wrong += same ? 0 : 1;
        });
        REQUIRE(b->session.streaming());
    }
    WARN(scans << " scans of " << beams << " beams, " << probability * 100 << " % of the bytes damaged: "
               << outcome.whole << " arrived whole, " << outcome.taken << " were delivered, " << outcome.wrong
               << " of them wrong; with right check characters, but refused: bad_scans "
               << b->session.listener().counters().bad_scans << ", bad_stamps "
               << b->session.listener().counters().bad_stamps);
    outcome.refused = b->session.listener().counters().bad_scans + b->session.listener().counters().bad_stamps;
    return outcome;
}

}  // namespace

TEST_CASE("scip damage: next to no wrong scan at 1 % of damaged bytes, none at 0.01 %") {
    const Outcome few = run(100'000, 0.01, 20);
    CHECK(few.wrong <= 10);  // 6 bits a line cannot do better: see how many pass
    CHECK(few.taken >= few.whole * 8 / 10);
    CHECK(few.refused > 100);  // the damage does pass the check characters: the further checks earn their place
    const Outcome rare = run(100'000, 0.0001, 20);
    CHECK(rare.wrong == 0);
    CHECK(rare.taken >= rare.whole * 999 / 1000);
    const Outcome real = run(10'000, 0.001, 682);
    CHECK(real.wrong <= 1);
}

TEST_CASE("scip damage: the scan after junk is delivered") {
    const auto b = std::make_unique<ScipBench>(ScipDeviceParams{urg_04lx(), false, 19'200}, ScipParams{});
    b->run(2.0);
    Rng rng(4);
    for (int i = 0; i < 200; ++i) {
        std::vector<std::uint8_t> junk(rng.next() % 5'000);
        for (std::uint8_t& c : junk) {
            c = static_cast<std::uint8_t>(rng.next() >> 8U);
        }
        b->session.on_bytes(junk, b->now, [](const Scan&) { FAIL("junk is no scan"); });
        // The junk has no end: the scan in which it ends may be lost, the one after it not.
        int n = 0;
        b->run(0.2, [&](const Scan&) { ++n; });
        REQUIRE(n >= 1);
    }
    CHECK(b->session.counters().failures == 0);
}
