#include "platform/capture/candump.hpp"

#include <catch2/catch.hpp>
#include <string>

#include "platform/capture/frames.hpp"
#include "tests/unit/platform/captures.hpp"
#include "tests/unit/platform/scratch.hpp"

using Catch::Matchers::Contains;
using crspf::CandumpLine;
using crspf::CanFrame;
using crspf::Direction;
using crspf::FrameContent;
using crspf::LinkKind;
using crspf::parse_candump_line;
using crspf::test::read_capture;
using crspf::test::Scratch;

namespace {

CanFrame frame_of(const std::string& text) {
    CandumpLine line;
    INFO(text);
    REQUIRE(parse_candump_line("(1.5) can0 " + text, line) == nullptr);
    return line.frame;
}

bool refused(const std::string& text) {
    CandumpLine line;
    return parse_candump_line(text, line) != nullptr;
}

}  // namespace

TEST_CASE("candump: a line is stamp, interface and frame") {
    CandumpLine line;
    REQUIRE(parse_candump_line("(1611227134.123456) can0 221#0064000A00000000", line) == nullptr);
    CHECK(line.stamp.ns == 1'611'227'134'123'456'000);
    CHECK(line.interface == "can0");
    CHECK(line.direction == Direction::kUnknown);
    CHECK(line.frame == CanFrame{.id = 0x221, .length = 8, .data = {0, 0x64, 0, 0x0A}});
    REQUIRE(parse_candump_line("(0000000001.000000001)   vcan12 123# T", line) == nullptr);
    CHECK(line.stamp.ns == 1'000'000'001);
    CHECK(line.interface == "vcan12");
    CHECK(line.direction == Direction::kSent);
    REQUIRE(parse_candump_line("(1.5) can0 123# R\r", line) == nullptr);
    CHECK(line.stamp.ns == 1'500'000'000);
    CHECK(line.direction == Direction::kReceived);
}

TEST_CASE("candump: every kind of frame") {
    CHECK(frame_of("18FEF100#0102") == CanFrame{.id = 0x18FEF100, .extended = true, .length = 2, .data = {1, 2}});
    CHECK(frame_of("00000123#") == CanFrame{.id = 0x123, .extended = true});
    CHECK(frame_of("123#R") == CanFrame{.id = 0x123, .remote = true});
    CHECK(frame_of("123#R8") == CanFrame{.id = 0x123, .remote = true, .length = 8});
    CHECK(frame_of("123#R8_F") == CanFrame{.id = 0x123, .remote = true, .length = 8});
    CHECK(frame_of("123#0102030405060708_E").length == 8);
    CHECK(frame_of("123##1aBcD") == CanFrame{.id = 0x123, .fd = true, .length = 2, .data = {0xAB, 0xCD}});
    CHECK(frame_of("123##0" + std::string(128, '0')).length == 64);
    CHECK(frame_of("20000040#0000000000000000") == CanFrame{.id = 0x40, .error = true, .length = 8});
}

TEST_CASE("candump: what is no such line is refused") {
    for (const char* const text : {"",
                                   "(1.5)",
                                   "(1.5) can0",
                                   "1.5 can0 123#",
                                   "(1.5 can0 123#",
                                   "(15) can0 123#",
                                   "(1.) can0 123#",
                                   "(.5) can0 123#",
                                   "(-1.5) can0 123#",
                                   "(1.-5) can0 123#",
                                   "(1.0123456789) can0 123#",
                                   "(9999999999999.5) can0 123#",
                                   "(1.5) can0 12#",
                                   "(1.5) can0 1234#",
                                   "(1.5) can0 12X#",
                                   "(1.5) can0 123",
                                   "(1.5) can0 123#0",
                                   "(1.5) can0 123#0X",
                                   "(1.5) can0 123#010203040506070809",
                                   "(1.5) can0 123#R9",
                                   "(1.5) can0 123#RX",
                                   "(1.5) can0 123##",
                                   "(1.5) can0 123##X01",
                                   "(1.5) can0 800#",
                                   "(1.5) can0 FFFFFFFF#",
                                   "(1.5) can0 123#01_",
                                   "(1.5) can0 123#-1",
                                   "(1.5) can0 -12#01",
                                   "(1.5) a_name_of_22_characters 123#"}) {
        INFO(text);
        CHECK(refused(text));
    }
    CHECK(refused("(1.5) can0 123##0" + std::string(130, '0')));
}

TEST_CASE("candump: a log is a recording with a source for each interface") {
    const Scratch scratch;
    const auto read =
        read_capture(scratch.file("log",
                                  "# driven by hand\n(1.000000) can1 123#01\n(2.0) can0 123#0203 T\n"
                                  "DROPCOUNT: dropped 3 CAN frames\n(2.5) can1 123#0X\n\n(3.0) can1 7FF#R"));
    CHECK(read.format == "candump");
    REQUIRE(read.sources.size() == 2);
    CHECK(read.sources[0].name == "can1");
    CHECK(read.sources[1].name == "can0");
    CHECK(read.sources[1].link == LinkKind::kCan);
    REQUIRE(read.records.size() == 3);
    CHECK(read.records[1].record.source == 1);
    CHECK(read.records[1].record.direction == Direction::kSent);
    CHECK(read.records[2].record.stamp.ns == 3'000'000'000);
    CHECK(read.counts.records == 3);
    CHECK(read.counts.ignored == 3);
    CHECK(read.counts.unusable == 1);
    CHECK_THAT(read.counts.first_unusable, Contains("log:5: not a CAN frame"));
    CanFrame frame;
    const auto bytes = crspf::test::bytes_of(read.records[1].bytes);
    REQUIRE(crspf::can_of(LinkKind::kCan, bytes, frame) == FrameContent::kFound);
    CHECK(frame == CanFrame{.id = 0x123, .length = 2, .data = {2, 3}});
}
