#include <algorithm>
#include <array>
#include <catch2/catch.hpp>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <iterator>
#include <memory>
#include <span>
#include <vector>

#include "drivers/ldrobot/ld06_listener.hpp"
#include "tests/unit/drivers/ld06_bench.hpp"

using namespace crspf;
using namespace crspf::test;

namespace {

using Bytes = std::array<std::uint8_t, kLd06Bytes>;

// The example of LDROBOT's manuals.
constexpr Bytes kManual{0x54, 0x2C, 0x68, 0x08, 0xAB, 0x7E, 0xE0, 0x00, 0xE4, 0xDC, 0x00, 0xE2, 0xD9, 0x00, 0xE5, 0xD5,
                        0x00, 0xE3, 0xD3, 0x00, 0xE4, 0xD0, 0x00, 0xE9, 0xCD, 0x00, 0xE4, 0xCA, 0x00, 0xE2, 0xC7, 0x00,
                        0xE9, 0xC5, 0x00, 0xE5, 0xC2, 0x00, 0xE5, 0xC0, 0x00, 0xE5, 0xBE, 0x82, 0x3A, 0x1A, 0x50};
// What a sensor in somebody's room said, as its log was published.
constexpr Bytes kHeard{0x54, 0x2C, 0x74, 0x08, 0xB0, 0x86, 0x00, 0x00, 0xD4, 0x00, 0x00, 0xD4, 0x00, 0x00, 0xD4, 0x00,
                       0x00, 0xD4, 0x00, 0x00, 0xD4, 0x00, 0x00, 0xD5, 0x00, 0x00, 0xD5, 0x00, 0x00, 0x49, 0x00, 0x00,
                       0x5F, 0x00, 0x00, 0xB0, 0x00, 0x00, 0xD2, 0x00, 0x00, 0xD4, 0x02, 0x89, 0x1E, 0x09, 0x1F};

/// Plays packets [from, to) but those for which `lost` says so, received without delay; returns the scans.
template <typename Lost>
std::vector<Scan> play(Ld06Listener& listener, std::uint64_t from, std::uint64_t to, Lost lost) {
    std::vector<Scan> scans;
    for (std::uint64_t n = from; n < to; ++n) {
        if (!lost(n)) {
            listener.on_bytes(ld06_bytes(ld06_packet(n)), ld06_sent(n),
                              [&](const Scan& scan) { scans.push_back(scan); });
        }
    }
    return scans;
}

constexpr auto kNoneLost = [](std::uint64_t) { return false; };

std::uint64_t packets_in(const std::vector<std::uint8_t>& bytes, Ld06ParserCounters& counters) {
    Ld06Parser parser;
    std::uint64_t packets = 0;
    for (const std::uint8_t byte : bytes) {  // as slowly as can be
        parser.feed({&byte, 1}, Stamp{}, [&](const Ld06Packet&, Stamp) { ++packets; });
    }
    parser.clear();
    counters = parser.counters();
    return packets;
}

}  // namespace

TEST_CASE("ld06: the manual's packet, and one of a real sensor") {
    Ld06Packet packet;
    REQUIRE(decode_ld06(kManual, packet));
    CHECK(packet.speed_degps == 2152);
    CHECK(packet.first_cdeg == 32427);
    CHECK(packet.last_cdeg == 33470);
    CHECK(packet.time_ms == 6714);
    CHECK(packet.readings[0] == Ld06Reading{224, 228});
    CHECK(packet.readings[11] == Ld06Reading{192, 229});
    CHECK(is_plausible(packet));
    CHECK(ld06_bytes(packet) == kManual);

    REQUIRE(decode_ld06(kHeard, packet));
    CHECK(packet.readings[7] == Ld06Reading{0, 0x49});
    CHECK(is_plausible(packet));
    CHECK(ld06_bytes(packet) == kHeard);

    Bytes small{};
    CHECK(encode_ld06(packet, std::span(small).first(kLd06Bytes - 1)) == 0);
}

TEST_CASE("ld06: any bit that is wrong is noticed") {
    Ld06Packet packet;
    for (std::size_t bit = 0; bit < 8 * kLd06Bytes; ++bit) {
        Bytes damaged = kManual;
        damaged[bit / 8] = static_cast<std::uint8_t>(damaged[bit / 8] ^ (1U << (bit % 8)));
        INFO(bit);
        CHECK_FALSE(decode_ld06(damaged, packet));
    }
    CHECK_FALSE(decode_ld06(std::span(kManual).first(kLd06Bytes - 1), packet));
}

TEST_CASE("ld06: the parser finds packets among other bytes, and counts these") {
    std::vector<std::uint8_t> bytes{0x54, 0x54, 0x00};
    const auto say = [&bytes](std::span<const std::uint8_t> said) {
        std::copy(said.begin(), said.end(), std::back_inserter(bytes));
    };
    say(kManual);
    say(std::span(kHeard).first(20));  // cut short by the next
    say(kHeard);
    Ld06Packet standing = ld06_packet(0);
    standing.speed_degps = 0;
    say(ld06_bytes(standing));
    bytes.push_back(0x54);
    Ld06ParserCounters counters;
    CHECK(packets_in(bytes, counters) == 2);
    CHECK(counters.packets == 2);
    CHECK(counters.bad_sum == 1);
    CHECK(counters.implausible == 1);
    CHECK(counters.bytes_dropped == 3 + 20 + kLd06Bytes + 1);
}

TEST_CASE("ld06: a revolution becomes a scan, counter-clockwise, from rear to rear") {
    const auto listener = std::make_unique<Ld06Listener>();
    const std::vector<Scan> scans = play(*listener, 0, 40 * 375 / 10, kNoneLost);  // 37.5 packets a revolution
    REQUIRE(scans.size() == 39);
    CHECK(listener->counters().bad_scans == 0);
    CHECK(listener->counters().lost_readings == 0);
    CHECK(listener->counters().ran_back == 0);
    for (std::size_t k = 0; k < scans.size(); ++k) {
        const Scan& scan = scans[k];
        REQUIRE(scan.count == 450);
        CHECK(std::abs(scan.angle_increment_rad - radians(kLd06Step_deg)) < 1e-5);
        CHECK(std::abs(scan.time_per_beam_s + kLd06Reading_s) < 1e-7);
        // Beam 0 is the reading just before the rear is passed. Reading 225 is the first behind it.
        const Stamp truth = ld06_measured(225 + 450 * (k + 1) - 1);
        CHECK(std::abs((scan.stamp - truth).seconds()) < 1.5e-3);
        for (std::uint32_t i = 0; i < scan.count; ++i) {
            const double angle_rad = scan.angle_min_rad + i * scan.angle_increment_rad;
            const double range_m = ld06_range_m(angle_rad);
            if (std::abs(std::abs(angle_rad) - radians(170.0)) < radians(kLd06Step_deg)) {
                continue;  // on one side of the wall's end or the other
            }
            INFO(k << ' ' << i);
            REQUIRE(scan.beam[i] == (range_m == 0.0 ? Beam::kNoReturn : Beam::kHit));
            REQUIRE(std::abs(static_cast<double>(scan.range_m[i]) - range_m) <
                    0.02);  // half a beam at 3 m, and rounding
        }
    }
}

TEST_CASE("ld06: what is lost is invalid, and counted, what two thirds of a turn were lost of is no scan") {
    const auto listener = std::make_unique<Ld06Listener>();
    const auto one = play(*listener, 0, 150, [](std::uint64_t n) { return n == 75; });
    REQUIRE(one.size() == 3);
    CHECK(listener->counters().lost_readings == kLd06Readings);
    CHECK(std::count(one[1].beam.begin(), one[1].beam.begin() + one[1].count, Beam::kInvalid) == kLd06Readings);
    CHECK(one[1].count == 450);

    const auto fresh = std::make_unique<Ld06Listener>();
    const auto half = play(*fresh, 0, 150, [](std::uint64_t n) { return n >= 60 && n < 85; });
    CHECK(half.size() == 2);
    CHECK(fresh->counters().bad_scans == 1);
}

TEST_CASE("ld06: the sensor's clock goes round, the line is opened anew, the sensor is switched off for long") {
    const auto listener = std::make_unique<Ld06Listener>();
    const std::uint64_t a_minute = std::uint64_t{60} * 375;
    for (const Scan& scan : play(*listener, 0, a_minute, kNoneLost)) {
        const double readings = (scan.stamp - Stamp{}).seconds() / kLd06Reading_s;
        REQUIRE(std::abs(std::remainder(readings - 224.0, 450.0)) < 6.8);  // 1.5 ms
    }
    CHECK(listener->counters().scans == 599);
    const std::uint64_t later = a_minute + std::uint64_t{20} * 375;
    const std::vector<Scan> after = play(*listener, later, later + 112, kNoneLost);
    REQUIRE(after.size() >= 2);
    CHECK(std::abs((after.back().stamp - ld06_sent(later + 112)).seconds()) < 0.15);
    listener->on_open();
    CHECK(play(*listener, later + 112, later + 187, kNoneLost).size() == 1);
}
