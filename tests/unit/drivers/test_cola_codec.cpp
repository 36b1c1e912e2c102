#include <catch2/catch.hpp>
#include <string_view>

#include "drivers/sick/cola_codec.hpp"
#include "tests/unit/drivers/sick_examples.hpp"

using namespace crspf;
using namespace crspf::test;

namespace {

Bytes command(SickCommand which, ColaDialect dialect = ColaDialect::kBinary, const SickScanConfig& config = {}) {
    Bytes bytes(kLargestColaCommand);
    bytes.resize(encode_command(which, dialect, config, bytes));
    return bytes;
}

ColaTelegram telegram(const Bytes& payload, ColaDialect dialect = ColaDialect::kAscii) {
    return {dialect, payload};
}

}  // namespace

TEST_CASE("cola codec: published commands, byte by byte") {
    CHECK(command(SickCommand::kSubscribe) ==
          hex("02 02 02 02 00 00 00 11 73 45 4E 20 4C 4D 44 73 63 61 6E 64 61 74 61 20 01 33"));
    CHECK(command(SickCommand::kLogin) == hex("02 02 02 02 00 00 00 17 73 4D 4E 20 53 65 74 41 63 63 65 73 73 4D 6F "
                                              "64 65 20 03 F4 72 47 44 B3"));
    const Bytes scan = command(SickCommand::kConfigureScan);
    REQUIRE(scan.size() == 8 + 0x25 + 1);
    CHECK(scan[7] == 0x25);
    CHECK(Bytes(scan.end() - 20, scan.end()) == hex("20 00 00 13 88 00 01 00 00 13 88 FF F9 22 30 00 22 55 10 21"));
    CHECK(command(SickCommand::kStartMeasuring).back() == 0x68);
    CHECK(command(SickCommand::kRun).back() == 0x19);
    CHECK(command(SickCommand::kReadScanConfig).back() == 0x63);
    // The published one asks for all echoes, 1F in place of our 01.
    const Bytes output = command(SickCommand::kConfigureOutput);
    REQUIRE(output.size() == 8 + 0x20 + 1);
    CHECK((output.back() ^ 0x01 ^ 0x1F) == 0x5C);
    CHECK(output[output.size() - 2] == 0x01);
}

TEST_CASE("cola codec: commands as text") {
    const ColaDialect a = ColaDialect::kAscii;
    CHECK(command(SickCommand::kLogin, a) == ascii("\x02sMN SetAccessMode 3 F4724744\x03"));
    CHECK(command(SickCommand::kConfigureScan, a) == ascii("\x02sMN mLMPsetscancfg 1388 1 1388 FFF92230 225510\x03"));
    CHECK(command(SickCommand::kConfigureOutput, a) == ascii("\x02sWN LMDscandatacfg 1 0 1 1 0 0 0 0 0 0 0 1\x03"));
    CHECK(command(SickCommand::kUseBinary, a) == ascii("\x02sWN EIHstCola 1\x03"));
    CHECK(command(SickCommand::kReadStatus, a) == ascii("\x02sRN STlms\x03"));
    CHECK(command(SickCommand::kUnsubscribe, a) == ascii("\x02sEN LMDscandata 0\x03"));
}

TEST_CASE("cola codec: a command that does not fit is not written") {
    Bytes bytes(20);
    CHECK(encode_command(SickCommand::kLogin, ColaDialect::kBinary, {}, bytes) == 0);
}

TEST_CASE("cola codec: replies") {
    const Bytes yes = ascii("sAN SetAccessMode 1");
    const Bytes no = ascii("sAN SetAccessMode 0");
    CHECK(answers(telegram(yes), SickCommand::kLogin));
    CHECK(accepted(telegram(yes), SickCommand::kLogin));
    CHECK_FALSE(accepted(telegram(no), SickCommand::kLogin));
    CHECK_FALSE(answers(telegram(yes), SickCommand::kRun));
    const Bytes status = ascii("sRA STlms 7 0 8 00:34:19 A 01.01.1970 0 0 0");
    CHECK(answers(telegram(status), SickCommand::kReadStatus));
    CHECK(telegram(status).fields().number<std::uint16_t>() == 7);
    const Bytes start = hex("73 41 4E 20 4C 4D 43 73 74 61 72 74 6D 65 61 73 20 00");  // sAN LMCstartmeas 0
    CHECK(answers(telegram(start, ColaDialect::kBinary), SickCommand::kStartMeasuring));
    CHECK(accepted(telegram(start, ColaDialect::kBinary), SickCommand::kStartMeasuring));
}

TEST_CASE("cola codec: refusals in words") {
    CHECK(refusal(telegram(ascii("sFA 3"))) == 3);
    CHECK(refusal(telegram(ascii("sFA A"))) == 10);
    CHECK(refusal(telegram(hex("73 46 41 20 00 03"), ColaDialect::kBinary)) == 3);
    CHECK(refusal(telegram(hex("73 46 41 20 03"), ColaDialect::kBinary)) == 3);
    CHECK(refusal(telegram(ascii("sAN Run 1"))) == 0);
    CHECK(std::string_view(refusal_text(3)) == "variable: not known to this sensor");
    CHECK(std::string_view(refusal_text(13)) == "method: server busy");
    CHECK(std::string_view(refusal_text(26)) == "complex arrays are not supported");
    CHECK(std::string_view(refusal_text(27)) == "number not listed");
}

TEST_CASE("cola fields: tokens") {
    const auto read = [](std::string_view text) {
        const Bytes bytes = ascii(text);
        ColaFieldReader in(bytes, ColaDialect::kAscii);
        const auto value = in.number<std::int32_t>();
        return in.ok() && in.left() == 0 ? value : 424242;
    };
    CHECK(read(" FFF92230") == -450000);
    CHECK(read(" +2250000") == 2250000);
    CHECK(read(" -450000") == -450000);
    CHECK(read(" 0") == 0);
    for (const std::string_view bad :
         {"", " ", "0", "  0", " 0 ", " 123456789", " G", " +A", " +", " 1+", " ff", " -2147483649", " +4294967296"}) {
        CAPTURE(bad);
        CHECK(read(bad) == 424242);
    }
    const Bytes wide = ascii(" 100");
    ColaFieldReader in(wide, ColaDialect::kAscii);
    CHECK(in.number<std::uint8_t>() == 0);
    CHECK_FALSE(in.ok());
}

TEST_CASE("cola fields: what is written is read, in either dialect") {
    Rng rng(1);
    int wrong = 0;
    for (int i = 0; i < 100000; ++i) {
        const ColaDialect dialect = i % 2 == 0 ? ColaDialect::kBinary : ColaDialect::kAscii;
        const auto a = static_cast<std::uint8_t>(rng.next());
        const auto b = static_cast<std::int16_t>(rng.next());
        const std::uint32_t c = rng.next() >> below(rng, 32);
        const auto d = static_cast<std::int32_t>(rng.next());
        const Bytes text = ascii(i % 3 == 0 ? "" : "a name");
        std::array<std::uint8_t, 64> buffer{};
        ColaFieldWriter out(buffer, dialect, "sRA Test");
        out.number(a);
        out.number(b);
        out.counted_text(text);
        out.number(c);
        out.number(d);
        const ColaTelegram sent{dialect, std::span(buffer).first(out.position())};
        ColaFieldReader in = sent.fields();
        const bool same = out.ok() && sent.is("sRA", "Test") && in.number<std::uint8_t>() == a &&
                          in.number<std::int16_t>() == b && spells(in.counted_text(), "a name") == !text.empty() &&
                          in.number<std::uint32_t>() == c && in.number<std::int32_t>() == d && in.ok() &&
                          in.left() == 0;
        wrong += same ? 0 : 1;
    }
    CHECK(wrong == 0);
}
