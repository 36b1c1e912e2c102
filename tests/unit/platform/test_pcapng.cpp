#include <array>
#include <catch2/catch.hpp>
#include <cstdint>
#include <string>
#include <vector>

#include "platform/capture/pcapng_writer.hpp"
#include "platform/files/input_error.hpp"
#include "tests/unit/platform/captures.hpp"
#include "tests/unit/platform/scratch.hpp"

using Catch::Matchers::Contains;
using crspf::CaptureRecord;
using crspf::CaptureSource;
using crspf::Direction;
using crspf::InputError;
using crspf::LinkKind;
using crspf::open_capture;
using crspf::Stamp;
using crspf::test::BlockMaker;
using crspf::test::Bytes;
using crspf::test::bytes_of;
using crspf::test::compressed;
using crspf::test::read_capture;
using crspf::test::ReadCapture;
using crspf::test::Scratch;
using crspf::test::text_of;
using crspf::wire::Order;

namespace {

const std::vector<CaptureSource> kSources{
    {"front", "VLP-16 on the roof", LinkKind::kEthernet}, {"can0", "", LinkKind::kCan}, {"", "", LinkKind::kStream}};

struct Sample {
    std::uint32_t source;
    Direction direction;
    std::int64_t stamp_ns;
    std::string bytes;
};

const std::vector<Sample> kSamples{{0, Direction::kReceived, 1'700'000'000'123'456'789, "frame"},
                                   {2, Direction::kSent, 1'700'000'000'123'456'790, "GD0044076801\n"},
                                   {1, Direction::kUnknown, 0, ""},
                                   {2, Direction::kReceived, 9'000'000'000'999'999'999, std::string(5000, 'x')}};

/// The file of the above, and where each of its blocks ends.
struct Written {
    Bytes bytes;
    std::vector<std::size_t> ends;
};

Written write_samples(std::string_view comment) {
    Written written;
    REQUIRE(crspf::pcapng::append_section(written.bytes, comment));
    written.ends.push_back(written.bytes.size());
    for (const CaptureSource& source : kSources) {
        REQUIRE(crspf::pcapng::append_source(written.bytes, source));
        written.ends.push_back(written.bytes.size());
    }
    for (const Sample& sample : kSamples) {
        const Bytes bytes = bytes_of(sample.bytes);
        const CaptureRecord record{sample.source, LinkKind::kOther,       sample.direction,
                                   false,         Stamp{sample.stamp_ns}, bytes};
        REQUIRE(crspf::pcapng::append_record(written.bytes, record));
        written.ends.push_back(written.bytes.size());
    }
    return written;
}

void check_samples(const ReadCapture& read, std::size_t count) {
    REQUIRE(read.records.size() == count);
    for (std::size_t i = 0; i < count; ++i) {
        const auto& [record, bytes] = read.records[i];
        CHECK(record.source == kSamples[i].source);
        CHECK(record.link == kSources[kSamples[i].source].link);
        CHECK(record.direction == kSamples[i].direction);
        CHECK(record.stamp.ns == kSamples[i].stamp_ns);
        CHECK_FALSE(record.cut);
        CHECK(bytes == kSamples[i].bytes);
    }
}

std::string section(Order order) {
    BlockMaker maker(order);
    return maker.put(std::uint32_t{0x1A2B3C4D})
        .put(std::uint16_t{1})
        .put(std::uint16_t{0})
        .put(~std::uint64_t{0})
        .block(0x0A0D0D0A);
}

std::string interface(Order order, std::string_view resolution, std::int64_t offset_s = 0) {
    BlockMaker maker(order);
    maker.put(std::uint16_t{1}).put(std::uint16_t{0}).put(std::uint32_t{0});
    if (!resolution.empty()) {
        maker.option(9, resolution);
    }
    if (offset_s != 0) {
        maker.put(std::uint16_t{14}).put(std::uint16_t{8}).put(static_cast<std::uint64_t>(offset_s));
    }
    return maker.option(0, "").block(1);
}

std::string packet(Order order, std::uint64_t ticks, std::string_view bytes, std::uint32_t interface_id = 0) {
    BlockMaker maker(order);
    const auto size = static_cast<std::uint32_t>(bytes.size());
    return maker.put(interface_id)
        .put(static_cast<std::uint32_t>(ticks >> 32U))
        .put(static_cast<std::uint32_t>(ticks))
        .put(size)
        .put(size)
        .put_bytes(bytes)
        .block(6);
}

}  // namespace

TEST_CASE("pcapng: what was written is read, plain and compressed") {
    const Scratch scratch;
    const std::string comment = "[lidar]\nmodel = \"vlp16\"\n";
    const std::string content = text_of(write_samples(comment).bytes);
    for (const std::string& text : {content, compressed(content, "xz"), compressed(content, "gzip")}) {
        const ReadCapture read = read_capture(scratch.file("a", text));
        CHECK(read.format == "pcapng");
        CHECK(read.comment == comment);
        CHECK(read.sources == kSources);
        CHECK(read.counts.records == kSamples.size());
        CHECK(read.counts.ignored + read.counts.unusable == 0);
        CHECK_FALSE(read.counts.cut_short);
        check_samples(read, kSamples.size());
    }
}

TEST_CASE("pcapng: a file cut at any byte is readable up to its last whole block") {
    const Scratch scratch;
    const Written written = write_samples("configuration");
    const std::string content = text_of(written.bytes);
    const std::size_t sources_end = written.ends[kSources.size()];
    int whole = 0;
    for (std::size_t cut = 12; cut < content.size(); ++cut) {
        const ReadCapture read = read_capture(scratch.file("cut", content.substr(0, cut)));
        std::size_t records = 0;
        bool between_blocks = false;
        for (const std::size_t end : written.ends) {
            records += end <= cut && end > sources_end ? 1 : 0;
            between_blocks = between_blocks || end == cut;
        }
        CAPTURE(cut);
        REQUIRE(read.records.size() == records);
        check_samples(read, records);
        REQUIRE(read.counts.cut_short != between_blocks);
        whole += between_blocks ? 1 : 0;
    }
    CHECK(whole == static_cast<int>(written.ends.size()) - 1);
    for (std::size_t cut = 4; cut < 12; ++cut) {
        CHECK(read_capture(scratch.file("cut", content.substr(0, cut))).counts.cut_short);
    }
}

TEST_CASE("pcapng: zeros behind the last block are a file cut short") {
    const Scratch scratch;
    const std::string content = text_of(write_samples("").bytes) + std::string(4096, '\0');
    const ReadCapture read = read_capture(scratch.file("zeros", content));
    CHECK(read.counts.cut_short);
    check_samples(read, kSamples.size());
}

TEST_CASE("pcapng: damage is an error that names file and byte, after what came before it") {
    const Scratch scratch;
    const Written written = write_samples("");
    const auto read_on = [](const std::filesystem::path& file) {
        std::size_t records = 0;
        const auto reader = open_capture(file);
        CaptureRecord record;
        try {
            while (reader->next(record)) {
                ++records;
            }
        } catch (const InputError&) {
            CHECK(records == 1);
            throw;
        }
    };
    const std::size_t second = written.ends[kSources.size() + 1];  // where the second record begins
    const std::string at = ": byte " + std::to_string(second) + ": ";
    for (const std::size_t place : {std::size_t{4}, std::size_t{6}, std::size_t{7}}) {
        std::string content = text_of(written.bytes);
        content[second + place] = static_cast<char>(content[second + place] ^ 0x81);
        CHECK_THROWS_WITH(read_on(scratch.file("damaged", content)), Contains("damaged" + at) && Contains("; "));
    }
    std::string content = text_of(written.bytes);
    content[written.ends[kSources.size() + 2] - 4] ^= 4;
    CHECK_THROWS_WITH(read_on(scratch.file("damaged", content)), Contains(at + "the two lengths of a block differ"));
}

TEST_CASE("pcapng: either byte order, by the section") {
    const Scratch scratch;
    std::string content;
    for (const Order order : {Order::kBig, Order::kLittle}) {
        content += section(order) + interface(order, "\x09") + packet(order, 0x0123'4567'89AB'CDEF, "abcde");
    }
    const ReadCapture read = read_capture(scratch.file("both", content));
    REQUIRE(read.records.size() == 2);
    REQUIRE(read.sources.size() == 2);  // each section describes its own
    for (std::uint32_t i = 0; i < 2; ++i) {
        CHECK(read.records[i].record.source == i);
        CHECK(read.records[i].record.stamp.ns == 0x0123'4567'89AB'CDEF);
        CHECK(read.records[i].bytes == "abcde");
    }
}

TEST_CASE("pcapng: every resolution and offset of stamps") {
    const Scratch scratch;
    struct Case {
        std::string resolution;
        std::uint64_t ticks;
        std::int64_t ns;
    };
    const std::vector<Case> cases{{"", 1'500'000, 1'500'000'000},  // microseconds where it does not say
                                  {"\x06", 1'000'001, 1'000'001'000},
                                  {std::string(1, '\0'), 7, 7'000'000'000},
                                  {"\x03", 1234, 1'234'000'000},
                                  {"\x0C", 3'000'000'512'000, 3'000'000'512},
                                  {"\x13", 10'000'000'000'000'000'000U, 1'000'000'000},
                                  {"\x81", 3, 1'500'000'000},
                                  {"\xA0", 0x1'8000'0000, 1'500'000'000},
                                  {"\xBF", 0xC000'0000'0000'0000, 1'500'000'000}};
    for (const Case& c : cases) {
        for (const std::int64_t offset_s : {0, 100, -1}) {
            const std::string content = section(Order::kLittle) + interface(Order::kLittle, c.resolution, offset_s) +
                                        packet(Order::kLittle, c.ticks, "x");
            const ReadCapture read = read_capture(scratch.file("resolution", content));
            REQUIRE(read.records.size() == 1);
            CHECK(read.records[0].record.stamp.ns == c.ns + offset_s * 1'000'000'000);
        }
    }
}

TEST_CASE("pcapng: what cannot be used is counted, and the reading goes on") {
    const Scratch scratch;
    const auto order = Order::kLittle;
    const std::string head = section(order) + interface(order, "\x09");
    const std::string good = packet(order, 5, "good");
    std::string long_packet = packet(order, 5, "long");
    long_packet[20] = 9;  // kept bytes
    const std::vector<std::pair<std::string, std::string>> cases{
        {packet(order, 5, "x", 1), "not described"},
        {packet(order, ~std::uint64_t{0}, "x"), "stamp out of range"},
        {long_packet, "longer than its block"},
        {BlockMaker(order).put(std::uint32_t{1}).put_bytes("x").block(3), "no stamp"},
        {interface(order, "\x14") + packet(order, 5, "x", 1), "stamp out of range"}};
    for (const auto& [bad, reason] : cases) {
        std::string capture = head;
        capture.append(good).append(bad).append(good);
        const ReadCapture read = read_capture(scratch.file("bad", capture));
        CHECK(read.records.size() == 2);
        CHECK(read.counts.unusable == 1);
        CHECK_THAT(read.counts.first_unusable, Contains("bad: byte ") && Contains(reason));
    }
    const std::string statistics = BlockMaker(order).put(std::uint32_t{0}).put(std::uint64_t{0}).block(5);
    CHECK(read_capture(scratch.file("ignored", head + statistics + good)).counts.ignored == 1);
}

TEST_CASE("pcapng: the writer refuses what the format cannot hold") {
    Bytes out;
    const std::string longest(crspf::pcapng::kTextMax, 'c');
    CHECK(crspf::pcapng::append_section(out, longest));
    const std::size_t size = out.size();
    CHECK_FALSE(crspf::pcapng::append_section(out, longest + "c"));
    CHECK_FALSE(crspf::pcapng::append_source(out, {longest + "c", "", LinkKind::kCan}));
    CHECK_FALSE(crspf::pcapng::append_source(out, {"", longest + "c", LinkKind::kCan}));
    CHECK_FALSE(crspf::pcapng::append_source(out, {"", "", LinkKind::kOther}));
    const Bytes large(CaptureRecord::kBytesMax + 1);
    CaptureRecord record;
    record.bytes = large;
    CHECK_FALSE(crspf::pcapng::append_record(out, record));
    record.bytes = record.bytes.first(CaptureRecord::kBytesMax);
    record.stamp.ns = -1;
    CHECK_FALSE(crspf::pcapng::append_record(out, record));
    CHECK(out.size() == size);
    record.stamp.ns = 0;
    CHECK(crspf::pcapng::append_record(out, record));
}

TEST_CASE("pcap: microseconds and nanoseconds, either byte order") {
    const Scratch scratch;
    for (const Order order : {Order::kLittle, Order::kBig}) {
        for (const bool nanoseconds : {false, true}) {
            Bytes file;
            const auto put = [&](std::uint32_t value) { crspf::wire::append(file, value, order); };
            put(nanoseconds ? 0xA1B23C4D : 0xA1B2C3D4);
            put(order == Order::kLittle ? 0x0004'0002 : 0x0002'0004);  // version, twice 16 bits
            put(0);
            put(0);
            put(65535);
            put(0xF000'0000U | 227U);  // the upper bits tell of frame check sequences
            const std::size_t header = file.size();
            for (const std::uint32_t had : {3U, 8U}) {
                put(1'700'000'000);
                put(123'456);
                put(3);
                put(had);
                file.insert(file.end(), {'a', 'b', 'c'});
            }
            const std::string content = text_of(file);
            const ReadCapture read = read_capture(scratch.file("classic", content));
            CHECK(read.format == "pcap");
            REQUIRE(read.records.size() == 2);
            CHECK(read.records[0].record.stamp.ns == 1'700'000'000'000'000'000 + (nanoseconds ? 123'456 : 123'456'000));
            CHECK(read.records[0].record.link == LinkKind::kCan);
            CHECK(read.records[0].bytes == "abc");
            CHECK_FALSE(read.records[0].record.cut);
            CHECK(read.records[1].record.cut);
            CHECK_FALSE(read.counts.cut_short);
            for (std::size_t cut = 4; cut < content.size(); ++cut) {
                const ReadCapture part = read_capture(scratch.file("part", content.substr(0, cut)));
                const bool boundary = cut == header || cut == header + 19;
                REQUIRE(part.records.size() == (cut >= header + 19 ? 1 : 0));
                REQUIRE(part.counts.cut_short != boundary);
            }
            const std::string zeros = content + std::string(40, '\0');
            CHECK(read_capture(scratch.file("zeros", zeros)).counts.cut_short);
            file[header + (order == Order::kLittle ? 10 : 9)] = 0x40;
            CHECK_THROWS_WITH(read_capture(scratch.file("huge", text_of(file))),
                              Contains("huge: byte 24: a record of"));
        }
    }
}

TEST_CASE("capture: what is none of the formats, or cannot be read, says so") {
    const Scratch scratch;
    CHECK_THROWS_WITH(open_capture(scratch.file("text", "hello\n")), Contains("text: byte 0: neither pcapng nor pcap"));
    CHECK_THROWS_WITH(open_capture(scratch.file("short", "a")), Contains("short: byte 0: neither"));
    CHECK_THROWS_WITH(open_capture(scratch / "none"), Contains("none: cannot be read"));
    CHECK_THROWS_WITH(open_capture(scratch.file("empty", "")), Contains("empty: empty; "));
    const std::string packed = compressed(text_of(write_samples("").bytes), "xz");
    const auto cut = scratch.file("cut.xz", packed.substr(0, packed.size() / 2));
    CHECK_THROWS_AS(read_capture(cut), InputError);
}
