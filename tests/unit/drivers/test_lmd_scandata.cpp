#include <catch2/catch.hpp>
#include <memory>

#include "drivers/common/byte_reader.hpp"
#include "drivers/sick/lmd_scandata.hpp"
#include "tests/unit/drivers/sick_examples.hpp"

using namespace crspf;
using namespace crspf::test;

namespace {

template <typename T>
T big(const Bytes& bytes, std::size_t at) {
    return ByteReader(std::span(bytes).subspan(at)).big<T>();
}

bool decode(const Bytes& payload, ColaDialect dialect, LmdScandata& data) {
    return decode_lmd_scandata({dialect, payload}, data);
}

Bytes payload_of(const LmdScandata& data, ColaDialect dialect) {
    Bytes payload(kLargestColaPayload);
    payload.resize(encode_lmd_scandata(data, dialect, payload));
    return payload;
}

bool equal(const LmdScandata& a, const LmdScandata& b) {
    bool same = a.version == b.version && a.device == b.device && a.serial == b.serial && a.status == b.status &&
                a.telegram_counter == b.telegram_counter && a.scan_counter == b.scan_counter &&
                a.start_us == b.start_us && a.transmit_us == b.transmit_us && a.inputs == b.inputs &&
                a.outputs == b.outputs && a.layer == b.layer &&
                a.scan_frequency_centihertz == b.scan_frequency_centihertz &&
                a.beam_frequency_hectohertz == b.beam_frequency_hectohertz && a.encoders == b.encoders &&
                a.channels16 == b.channels16 && a.channels8 == b.channels8 && a.has_time == b.has_time;
    for (std::size_t i = 0; i < a.encoders; ++i) {
        same = same && a.encoder[i] == b.encoder[i];
    }
    for (std::size_t i = 0; i < std::size_t{a.channels16} + a.channels8; ++i) {
        const auto va = a.of(a.channel[i]);
        const auto vb = b.of(b.channel[i]);
        same = same && a.channel[i] == b.channel[i] && std::equal(va.begin(), va.end(), vb.begin(), vb.end());
    }
    return same && (!a.has_time ||
                    (a.year == b.year && a.month_to_second == b.month_to_second && a.microsecond == b.microsecond));
}

void randomise(LmdScandata& data, Rng& rng) {
    const auto u16 = [&] { return static_cast<std::uint16_t>(rng.next()); };
    const auto u8 = [&] { return static_cast<std::uint8_t>(rng.next()); };
    data.version = u16();
    data.device = u16();
    data.serial = rng.next();
    data.status = {u8(), u8()};
    data.telegram_counter = u16();
    data.scan_counter = u16();
    data.start_us = rng.next();
    data.transmit_us = rng.next();
    data.inputs = {u8(), u8()};
    data.outputs = {u8(), u8()};
    data.layer = u16();
    data.scan_frequency_centihertz = rng.next();
    data.beam_frequency_hectohertz = rng.next();
    data.encoders = static_cast<std::uint16_t>(below(rng, 4));
    for (SickEncoder& encoder : data.encoder) {
        encoder = {static_cast<std::int32_t>(rng.next()), static_cast<std::int16_t>(rng.next())};
    }
    data.channels16 = static_cast<std::uint16_t>(below(rng, 5));
    data.channels8 = static_cast<std::uint16_t>(below(rng, 3));
    std::uint16_t used = 0;
    for (std::size_t i = 0; i < std::size_t{data.channels16} + data.channels8; ++i) {
        const auto count = static_cast<std::uint16_t>(below(rng, 400));
        data.channel[i] = {{'R', 'S', 'S', 'I', static_cast<char>('1' + i)},
                           static_cast<float>(rng.symmetric()),
                           static_cast<float>(rng.symmetric()),
                           static_cast<std::int32_t>(rng.next()),
                           static_cast<std::int16_t>(rng.next()),
                           used,
                           count};
        for (std::size_t k = 0; k < count; ++k) {
            data.values[used + k] = i < data.channels16 ? u16() : u8();
        }
        used = static_cast<std::uint16_t>(used + count);
    }
    data.has_time = below(rng, 2) == 1;
    data.year = u16();
    data.month_to_second = {u8(), u8(), u8(), u8(), u8()};
    data.microsecond = rng.next();
}

}  // namespace

TEST_CASE("lmd scandata: the layout of the published capture") {
    auto data = std::make_unique<LmdScandata>();
    fill_tim(*data);
    const Bytes bytes = framed(*data, ColaDialect::kBinary);
    REQUIRE(bytes.size() == 3365 + 9);
    CHECK(big<std::uint32_t>(bytes, 4) == 3365);
    CHECK(big<std::uint16_t>(bytes, 24) == 1);
    CHECK(big<std::uint32_t>(bytes, 28) == 18480390);
    CHECK(big<std::uint16_t>(bytes, 34) == 44977);
    CHECK(big<std::uint16_t>(bytes, 36) == 44981);
    CHECK(big<std::uint32_t>(bytes, 38) == 3014133219);
    CHECK(big<std::uint32_t>(bytes, 42) == 3014139433);
    CHECK(big<std::uint16_t>(bytes, 48) == 0x0800);
    CHECK(big<std::uint32_t>(bytes, 52) == 1500);
    CHECK(big<std::uint32_t>(bytes, 56) == 162);
    CHECK(big<std::uint16_t>(bytes, 60) == 0);
    CHECK(big<std::uint16_t>(bytes, 62) == 2);
    CHECK(Bytes(bytes.begin() + 64, bytes.begin() + 69) == ascii("DIST1"));
    CHECK(big<std::uint32_t>(bytes, 69) == 0x3F800000);
    CHECK(big<std::int32_t>(bytes, 77) == -450000);
    CHECK(big<std::uint16_t>(bytes, 81) == 3333);
    CHECK(big<std::uint16_t>(bytes, 83) == 811);
    CHECK(Bytes(bytes.end() - 24, bytes.end() - 1) ==
          hex("00 00 00 00 00 00 00 00 00 01 07 B2 01 01 00 32 0E 00 02 13 40 00 00"));

    auto back = std::make_unique<LmdScandata>();
    CHECK(decode(Bytes(bytes.begin() + 8, bytes.end() - 1), ColaDialect::kBinary, *back));
    CHECK(equal(*data, *back));
}

TEST_CASE("lmd scandata: a telegram of text, token by token") {
    const Bytes text = ascii(
        "sSN LMDscandata 1 1 119FD36 0 0 AFB1 AFB5 B3A7C823 B3A7E069 0 0 8 0 0 5DC A2 1 FFFFFFFE FFFF 1 "
        "DIST1 3F800000 00000000 FFF92230 2710 3 0 3E8 FFFF 1 RSSI1 3F800000 0 FFF92230 2710 2 FF 0 "
        "0 1 7 Daniyal 0 0 0");
    auto data = std::make_unique<LmdScandata>();
    REQUIRE(decode(text, ColaDialect::kAscii, *data));
    CHECK(data->serial == 18480438);
    CHECK(data->telegram_counter == 0xAFB1);
    CHECK(data->start_us == 0xB3A7C823);
    CHECK(data->outputs[0] == 8);
    CHECK(data->scan_frequency_centihertz == 1500);
    CHECK(data->encoders == 1);
    CHECK(data->encoder[0] == SickEncoder{-2, -1});
    REQUIRE(data->channels16 == 1);
    CHECK(data->channel[0].scale == 1.0F);
    CHECK(data->channel[0].start_1e4deg == -450000);
    CHECK(data->channel[0].step_1e4deg == 10000);
    CHECK(data->of(data->channel[0])[1] == 1000);
    CHECK(data->of(data->channel[0])[2] == 0xFFFF);
    REQUIRE(data->channels8 == 1);
    CHECK(data->of(data->channel[1])[0] == 0xFF);
    CHECK_FALSE(data->has_time);
}

TEST_CASE("lmd scandata: blocks that we never ask for are passed over") {
    auto data = std::make_unique<LmdScandata>();
    fill_tim(*data, 3);
    data->has_time = false;
    const Bytes plain = payload_of(*data, ColaDialect::kBinary);
    Bytes rich(plain.begin(), plain.end() - 10);
    append(rich, hex("00 01"));
    rich.resize(rich.size() + 25);
    append(rich, hex("00 01 03 41 42 43 00 01 02 44 45 00 00 00 01 46 41 4C 4C"));
    rich.resize(rich.size() + 12);
    auto back = std::make_unique<LmdScandata>();
    CHECK(decode(rich, ColaDialect::kBinary, *back));
    CHECK(equal(*data, *back));
    // Older firmware has no event.
    CHECK(decode(Bytes(plain.begin(), plain.end() - 2), ColaDialect::kBinary, *back));
}

TEST_CASE("lmd scandata: whatever is missing or left over is refused") {
    auto data = std::make_unique<LmdScandata>();
    fill_tim(*data, 5);
    data->has_time = false;  // a number cut short is still a number, and the event behind it may be absent
    for (const ColaDialect dialect : {ColaDialect::kBinary, ColaDialect::kAscii}) {
        const Bytes payload = payload_of(*data, dialect);
        auto back = std::make_unique<LmdScandata>();
        REQUIRE(decode(payload, dialect, *back));
        const std::size_t event = 2;  // bytes of the last field in either dialect
        for (std::size_t n = 0; n < payload.size(); ++n) {
            if (n != payload.size() - event) {
                CAPTURE(n);
                CHECK_FALSE(
                    decode(Bytes(payload.begin(), payload.begin() + static_cast<std::ptrdiff_t>(n)), dialect, *back));
            }
        }
        Bytes longer = payload;
        longer.push_back(' ');
        CHECK_FALSE(decode(longer, dialect, *back));
    }
}

TEST_CASE("lmd scandata: a channel may not claim more values than the telegram holds") {
    auto data = std::make_unique<LmdScandata>();
    fill_tim(*data, 5);
    Bytes payload = payload_of(*data, ColaDialect::kBinary);
    payload[83 - 8] = 0xFF;  // count of DIST1
    CHECK_FALSE(decode(payload, ColaDialect::kBinary, *data));
}

TEST_CASE("lmd scandata: what is written is read, a million values in either dialect") {
    Rng rng(3);
    auto data = std::make_unique<LmdScandata>();
    auto back = std::make_unique<LmdScandata>();
    std::size_t values = 0;
    int wrong = 0;
    while (values < 2'000'000) {
        randomise(*data, rng);
        for (std::size_t i = 0; i < std::size_t{data->channels16} + data->channels8; ++i) {
            values += std::size_t{2} * data->channel[i].count;
        }
        for (const ColaDialect dialect : {ColaDialect::kBinary, ColaDialect::kAscii}) {
            const Bytes payload = payload_of(*data, dialect);
            wrong += !payload.empty() && decode(payload, dialect, *back) && equal(*data, *back) ? 0 : 1;
        }
    }
    CHECK(wrong == 0);
    ++back->values[back->channel[0].first];
    back->channels16 = 1;
    back->channel[0].count = 1;
    CHECK_FALSE(equal(*data, *back));  // control
}
