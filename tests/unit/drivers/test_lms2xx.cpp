#include <catch2/catch.hpp>
#include <cstdio>
#include <memory>

#include "drivers/sick/lms2xx_codec.hpp"
#include "drivers/sick/lms2xx_parser.hpp"
#include "drivers/sick/lms2xx_scan.hpp"
#include "drivers/sick/lms2xx_session.hpp"
#include "tests/unit/drivers/sick_examples.hpp"

using namespace crspf;
using namespace crspf::test;

namespace {

Bytes mode(Lms2xxMode which) {
    Bytes bytes(kLargestLms2xxTelegram);
    bytes.resize(encode_lms2xx_mode(which, bytes));
    return bytes;
}

Bytes variant(const Lms2xxVariant& which) {
    Bytes bytes(kLargestLms2xxTelegram);
    bytes.resize(encode_lms2xx_variant(which, bytes));
    return bytes;
}

Bytes framed(const Lms2xxScan& scan) {
    std::array<std::uint8_t, kLargestLms2xxPayload> payload{};
    const std::size_t size = encode_lms2xx_scan(scan, payload);
    Bytes bytes(kLargestLms2xxTelegram);
    bytes.resize(encode_lms2xx(kLms2xxFromSensor, std::span(payload).first(size), bytes));
    return bytes;
}

bool equal(const Lms2xxScan& a, const Lms2xxScan& b) {
    return a.unit == b.unit && a.partial == b.partial && a.partial_index == b.partial_index && a.count == b.count &&
           std::equal(a.values.begin(), a.values.begin() + a.count, b.values.begin()) && a.indices == b.indices &&
           std::equal(a.index.begin(), a.index.begin() + a.indices, b.index.begin()) && a.status == b.status;
}

void randomise(Lms2xxScan& scan, Rng& rng) {
    scan.unit = static_cast<Lms2xxScan::Unit>(below(rng, 2));
    scan.partial = below(rng, 2) == 1;
    scan.partial_index = static_cast<std::uint8_t>(below(rng, 4));
    scan.count = static_cast<std::uint16_t>(1 + below(rng, 401));
    for (std::size_t i = 0; i < scan.count; ++i) {
        scan.values[i] = static_cast<std::uint16_t>(rng.next());
    }
    scan.indices = static_cast<std::uint8_t>(below(rng, 3));
    scan.index = {static_cast<std::uint8_t>(rng.next()), static_cast<std::uint8_t>(rng.next())};
    scan.status = static_cast<std::uint8_t>(rng.next());
}

}  // namespace

TEST_CASE("lms2xx codec: published commands, byte by byte") {
    CHECK(mode(Lms2xxMode::kStreamAll) == hex("02 00 02 00 20 24 34 08"));
    CHECK(mode(Lms2xxMode::kOnRequest) == hex("02 00 02 00 20 25 35 08"));
    CHECK(mode(Lms2xxMode::kBaud38400) == hex("02 00 02 00 20 40 50 08"));
    CHECK(mode(Lms2xxMode::kBaud19200) == hex("02 00 02 00 20 41 51 08"));
    CHECK(mode(Lms2xxMode::kBaud9600) == hex("02 00 02 00 20 42 52 08"));
    CHECK(mode(Lms2xxMode::kBaud500000) == hex("02 00 02 00 20 48 58 08"));
    CHECK(mode(Lms2xxMode::kInstallation) == hex("02 00 0A 00 20 00 53 49 43 4B 5F 4C 4D 53 BE C5"));
    CHECK(variant({180, 50}) == hex("02 00 05 00 3B B4 00 32 00 3B 1F"));
    CHECK(variant({100, 25}) == hex("02 00 05 00 3B 64 00 19 00 E7 72"));
    CHECK(variant({180, 100}) == hex("02 00 05 00 3B B4 00 64 00 97 49"));
    Bytes status(16);
    status.resize(encode_lms2xx_status_request(status));
    CHECK(status == hex("02 00 01 00 31 15 12"));
}

TEST_CASE("lms2xx codec: a scan of 361 values has 732 bytes") {
    Lms2xxScan scan;
    scan.count = 361;
    scan.unit = Lms2xxScan::Unit::kMillimetre;
    const Bytes bytes = framed(scan);
    CHECK(bytes.size() == 732);
    CHECK(bytes[4] == 0xB0);
    CHECK(bytes[5] == 0x69);
    CHECK(bytes[6] == 0x41);  // 361 in the low bits, unit 1 at the top
    scan.partial_index = 3;
    CHECK(framed(scan)[6] == 0x59);
}

TEST_CASE("lms2xx codec: scans that are none") {
    Lms2xxScan scan;
    CHECK_FALSE(decode_lms2xx_scan(hex("B0 01 00 11 22"), scan));  // no status
    CHECK(decode_lms2xx_scan(hex("B0 01 00 11 22 10"), scan));
    CHECK(decode_lms2xx_scan(hex("B0 01 00 11 22 01 02 10"), scan));
    CHECK_FALSE(decode_lms2xx_scan(hex("B0 01 00 11 22 01 02 03 10"), scan));  // too much
    CHECK_FALSE(decode_lms2xx_scan(hex("B1 01 00 11 22 10"), scan));
    CHECK_FALSE(decode_lms2xx_scan(hex("B0 01 80 11 22 10"), scan));  // unit 2
    CHECK_FALSE(decode_lms2xx_scan(hex("B0 FF 03 11 22 10"), scan));
    CHECK_FALSE(decode_lms2xx_scan(hex("B0 00 00 10"), scan));
    CHECK_FALSE(decode_lms2xx_scan({}, scan));
}

TEST_CASE("lms2xx parser: what is written is read, a million values, cut anywhere") {
    Rng rng(11);
    Lms2xxScan sent;
    Lms2xxScan got;
    Lms2xxParser parser;
    std::size_t values = 0;
    int scans = 0;
    int right = 0;
    while (values < 1'000'000) {
        randomise(sent, rng);
        values += sent.count;
        ++scans;
        const Bytes bytes = framed(sent);
        const std::size_t cut = below(rng, static_cast<std::uint32_t>(bytes.size()));
        const auto visit = [&](const Lms2xxMessage& message, Stamp) {
            right +=
                message.address == kLms2xxFromSensor && decode_lms2xx_scan(message.payload, got) && equal(sent, got)
                    ? 1
                    : 0;
        };
        parser.feed(std::span(bytes).first(cut), Stamp{}, visit);
        parser.feed(std::span(bytes).subspan(cut), Stamp{}, visit);
    }
    CHECK(right == scans);
    CHECK(parser.counters().bytes_skipped == 0);
    sent.values[0] ^= 1;
    CHECK_FALSE(equal(sent, got));  // control
}

TEST_CASE("lms2xx parser: acknowledgements between telegrams") {
    Bytes bytes = hex("06");
    append(bytes, mode(Lms2xxMode::kStreamAll));
    append(bytes, hex("15"));
    std::vector<Lms2xxMessage::Kind> kinds;
    Lms2xxParser parser;
    parser.feed(bytes, Stamp{}, [&](const Lms2xxMessage& message, Stamp) { kinds.push_back(message.kind); });
    using Kind = Lms2xxMessage::Kind;
    CHECK(kinds == std::vector<Kind>{Kind::kAck, Kind::kTelegram, Kind::kNack});
}

TEST_CASE("lms2xx parser: a telegram that broke off does not swallow the reply behind the pause") {
    Lms2xxScan scan;
    scan.count = 361;
    Bytes half = framed(scan);
    half.resize(300);
    Lms2xxParser parser;
    int telegrams = 0;
    const auto visit = [&](const Lms2xxMessage& message, Stamp) {
        telegrams += message.kind == Lms2xxMessage::Kind::kTelegram ? 1 : 0;
    };
    parser.feed(half, Stamp{}, visit);
    parser.feed(mode(Lms2xxMode::kOnRequest), Stamp{} + Duration::from_seconds(0.5), visit);
    CHECK(telegrams == 1);
    CHECK(parser.counters().broken_off == 1);
}

TEST_CASE("lms2xx stream: 1 % of bytes wrong, dropped or inserted") {
    Rng rng(13);
    const int n = 9000;
    Lms2xxParser parser;
    Lms2xxScan sent;
    Lms2xxScan got;
    int wrong = 0;
    std::vector<bool> seen(n);
    const auto value = [](int telegram, std::size_t i) {
        return static_cast<std::uint16_t>(static_cast<std::uint64_t>(telegram) * 2654435761U + i * 40503U);
    };
    for (int k = 0; k < n; ++k) {
        sent.count = 181;
        sent.values[0] = static_cast<std::uint16_t>(k);
        for (std::size_t i = 1; i < sent.count; ++i) {
            sent.values[i] = value(k, i);
        }
        const Bytes sound = framed(sent);
        const Bytes bytes = k % 3 == 2 ? damaged(sound, 10, rng) : sound;
        parser.feed(bytes, Stamp{}, [&](const Lms2xxMessage& message, Stamp) {
            if (message.kind != Lms2xxMessage::Kind::kTelegram || !decode_lms2xx_scan(message.payload, got)) {
                return;
            }
            const int of = got.values[0];
            bool same = got.count == 181 && of < n;
            for (std::size_t i = 1; same && i < got.count; ++i) {
                same = got.values[i] == value(of, i);
            }
            if (same) {
                seen[static_cast<std::size_t>(of)] = true;
            } else {
                ++wrong;
            }
        });
    }
    int first_lost = 0;
    int second_lost = 0;
    for (std::size_t k = 3; k + 1 < seen.size(); k += 3) {
        first_lost += seen[k] ? 0 : 1;
        second_lost += seen[k + 1] ? 0 : 1;
    }
    std::printf(
        "sick: LMS2xx, every third telegram damaged: %d wrong, of the next ones %d of %d lost, of those behind "
        "%d; %u bad sums\n",
        wrong, first_lost, n / 3 - 1, second_lost, static_cast<unsigned>(parser.counters().bad_sums));
    CHECK(wrong == 0);
    CHECK(second_lost == 0);
    CHECK(parser.counters().bad_sums > 0);  // control
}

TEST_CASE("lms2xx scan: units, flags, codes, angles") {
    Lms2xxScan raw;
    raw.count = 181;
    raw.unit = Lms2xxScan::Unit::kMillimetre;
    raw.values.fill(0xE000 | 2000);  // all flags set
    raw.values[1] = 0x1FFF;
    raw.values[2] = 0x1FF7;
    raw.values[3] = 0x1FFE;
    raw.values[4] = 10;
    auto scan = std::make_unique<Scan>();
    REQUIRE(fill_lms2xx_scan(raw, 0x1FFF, {}, Stamp{5}, *scan));
    CHECK(scan->count == 181);
    CHECK(scan->stamp == Stamp{5});
    CHECK(scan->angle_min_rad == Approx(-1.5707963));
    CHECK(scan->angle_increment_rad == Approx(0.01745329));
    CHECK(scan->time_per_beam_s == Approx(1.0 / 75 / 360));
    CHECK(scan->range_m[0] == 2.0F);
    CHECK(scan->beam[0] == Beam::kHit);
    CHECK(scan->beam[1] == Beam::kNoReturn);
    CHECK(scan->beam[2] == Beam::kNoReturn);
    CHECK(scan->beam[3] == Beam::kInvalid);
    CHECK(scan->beam[4] == Beam::kInvalid);
    raw.unit = Lms2xxScan::Unit::kCentimetre;
    LidarParams hanging;
    hanging.mount_inverted = true;
    REQUIRE(fill_lms2xx_scan(raw, 0x1FFF, hanging, Stamp{5}, *scan));
    CHECK(scan->range_m[180] == 20.0F);
    CHECK(scan->beam[179] == Beam::kNoReturn);
    CHECK(scan->angle_min_rad == Approx(-1.5707963));
    CHECK(scan->time_per_beam_s < 0.0);
    // Quarters of a degree by four turns of whole degrees.
    raw.partial = true;
    raw.partial_index = 3;
    raw.count = 101;
    REQUIRE(fill_lms2xx_scan(raw, 0x1FFF, {}, Stamp{5}, *scan));
    CHECK(scan->angle_min_rad == Approx(-49.25 * 0.01745329252));
    raw.count = 100;
    CHECK_FALSE(fill_lms2xx_scan(raw, 0x1FFF, {}, Stamp{5}, *scan));
}
