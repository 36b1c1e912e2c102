#include <algorithm>
#include <array>
#include <catch2/catch.hpp>
#include <string>
#include <string_view>
#include <vector>

#include "core/base/rng.hpp"
#include "drivers/can/candump_line.hpp"

using namespace crspf;
using Kind = CandumpLine::Kind;

namespace {

std::string formatted(const CandumpLine& line) {
    std::array<char, kCandumpLineMax> buffer{};
    return {buffer.data(), format_candump_line(line, buffer)};
}

}  // namespace

TEST_CASE("candump: lines as the recorder writes them come back to the byte") {
    for (const std::string_view text : {
             "(1611227134.123456) can0 221#0064000A00000000",
             "(1234567890.567890) can0 123#DEADBEEF",
             "(1627306199.804750) can2 17F00010#0341628800000000",
             "(0000000000.000000) vcan0 7FF#",
             "(1234567890.123456789) can0 123#00",
             "(1234567890.567890) can0 123#R",
             "(1234567890.567890) can0 1ABCDEF0#R8",
             "(1234567890.567890) can0 123##1112233445566778899AABBCC",
             "(1234567890.567890) can0 123##0",
             "(1234567890.567890) can0 20000004#000C000000000000",
             "(1234567890.567890) can0 123#11 R",
             "(1234567890.567890) a21charsinterfacename 123#11 T",
         }) {
        INFO(text);
        const CandumpLine line = parse_candump_line(text);
        REQUIRE(line.kind == Kind::kFrame);
        CHECK(formatted(line) == text);
    }
    const CandumpLine line = parse_candump_line("(1611227134.123456) can0 221#0064000A00000000\r\n");
    CHECK(line.stamp.ns == 1611227134123456000);
    CHECK(line.interface == "can0");
    CHECK(line.frame.id == 0x221);
    CHECK(line.frame.length == 8);
    CHECK(line.frame.data[3] == 0x0A);
    CHECK_FALSE(line.frame.extended);
    CHECK(parse_candump_line("(1.000000) c 00000123#").frame.extended);
    CHECK(parse_candump_line("(1.000000) c 20000040#0000000000000000").frame.error);
    CHECK(parse_candump_line("(1.000000) c 123##7").frame.fd_flags == 3);
}

TEST_CASE("candump: spellings that other writers use") {
    CHECK(parse_candump_line("  (1.000000)    can0   123#11.22.33  R ").frame.length == 3);
    CHECK(parse_candump_line("(1.000000) can0 123#deadbeef").frame.data[0] == 0xDE);
    CHECK(parse_candump_line("(1.000000) can0 123#1122334455667788_F").frame.length == 8);
    CHECK(parse_candump_line("").kind == Kind::kNothing);
    CHECK(parse_candump_line(" \r\n").kind == Kind::kNothing);
    CHECK(parse_candump_line("DROPCOUNT: dropped 3 CAN frames on 'can0' socket (total drops 3)").kind == Kind::kDrops);
}

TEST_CASE("candump: what is wrong is named with its column") {
    struct Example {
        std::string_view text;
        std::size_t column;
    };
    for (const Example& e : std::vector<Example>{{"can0 123#11", 1},
                                                 {"(1,5) can0 123#11", 3},
                                                 {"(-1.000000) can0 123#11", 2},
                                                 {"(1.00000) can0 123#11", 9},
                                                 {"(1.0000000000) can0 123#11", 13},
                                                 {"(1.000000)", 11},
                                                 {"(1.000000) a22characters_interface 123#11", 35},
                                                 {"(1.000000) can0 1234#11", 21},
                                                 {"(1.000000) can0 800#11", 20},
                                                 {"(1.000000) can0 80000000#11", 25},
                                                 {"(1.000000) can0 123", 20},
                                                 {"(1.000000) can0 123#1", 22},
                                                 {"(1.000000) can0 123#112233445566778899", 38},
                                                 {"(1.000000) can0 123#1122 X", 26},
                                                 {"(1.000000) can0 123#11 R T", 26},
                                                 {"(1.000000) can0 123##", 22},
                                                 {"(1.000000) can0 123##1112233445566778899", 41},
                                                 {"(1.000000) can0 123#R9", 22},
                                                 {"(1.000000) can0 123#1122334455667788_1", 38}}) {
        INFO(e.text);
        const CandumpLine line = parse_candump_line(e.text);
        CHECK(line.kind == Kind::kBad);
        CHECK(line.column == e.column);
        CHECK(line.reason != nullptr);
    }
}

TEST_CASE("candump: random frames come back; what is no frame is not written") {
    Rng rng(11);
    constexpr std::array<std::uint8_t, 16> kLengths = {0, 1, 2, 3, 4, 5, 6, 7, 8, 12, 16, 20, 24, 32, 48, 64};
    std::uint64_t wrong = 0;
    for (int i = 0; i < 100000; ++i) {
        CandumpLine line{.kind = Kind::kFrame, .interface = "can1"};
        line.stamp.ns = std::int64_t{rng.next() >> 1U} * rng.next();
        CanFrame& frame = line.frame;
        frame.extended = rng.next() % 2 == 0;
        frame.id = rng.next() & (frame.extended ? 0x1FFFFFFFU : 0x7FFU);
        frame.fd = rng.next() % 2 == 0;
        frame.fd_flags = static_cast<std::uint8_t>(frame.fd ? rng.next() % 4 : 0);
        frame.length = kLengths[rng.next() % (frame.fd ? 16 : 9)];
        frame.remote = !frame.fd && rng.next() % 8 == 0;
        std::generate_n(frame.data.begin(), frame.remote ? 0 : frame.length,
                        [&] { return static_cast<std::uint8_t>(rng.next()); });
        line.direction = static_cast<CanDirection>(rng.next() % 3);
        const std::string text = formatted(line);
        const CandumpLine back = parse_candump_line(text);
        wrong +=
            back.kind == Kind::kFrame && back.frame == frame && back.stamp == line.stamp && back.direction == line.direction && back.interface == line.interface ? 0U
                                                                                                                                                                 : 1U;
    }
    CHECK(wrong == 0);

    CandumpLine line{.kind = Kind::kFrame, .interface = "can0"};
    CHECK_FALSE(formatted(line).empty());
    std::array<char, 10> small{};
    CHECK(format_candump_line(line, small) == 0);
    line.frame.id = 0x800;
    CHECK(formatted(line).empty());
    line.frame.id = 0;
    line.frame.length = 9;
    CHECK(formatted(line).empty());
    line.frame.length = 0;
    line.interface = "can 0";
    CHECK(formatted(line).empty());
}
