#include "tools/view/mcap_writer.hpp"

#include <zlib.h>
#include <zstd.h>

#include <catch2/catch.hpp>
#include <cstring>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "platform/files/input_error.hpp"
#include "tests/unit/platform/scratch.hpp"
#include "tools/view/mcap_records.hpp"

using namespace crspf::view;
using crspf::test::content_of;
using crspf::test::Scratch;

namespace {

/// Reads little-endian numbers and texts off its front.
struct Cursor {
    std::string_view rest;

    template <class T>
    T number() {
        REQUIRE(rest.size() >= sizeof(T));
        T value = 0;
        for (std::size_t i = sizeof(T); i > 0; --i) {
            value = static_cast<T>(static_cast<std::uint64_t>(value) << 8U | static_cast<std::uint8_t>(rest[i - 1]));
        }
        rest.remove_prefix(sizeof(T));
        return value;
    }
    /// 64 bits of the file, as this machine counts bytes.
    std::size_t size() {
        std::size_t value = 0;
        std::vector<std::uint8_t> places;
        for (const char c : bytes(8)) {
            places.push_back(static_cast<std::uint8_t>(c));
        }
        for (; !places.empty(); places.pop_back()) {
            value = value << 8U | places.back();
        }
        return value;
    }
    std::string_view bytes(std::size_t count) {
        REQUIRE(rest.size() >= count);
        const std::string_view front = rest.substr(0, count);
        rest.remove_prefix(count);
        return front;
    }
    std::string_view text() { return bytes(number<std::uint32_t>()); }
};

struct Record {
    std::uint8_t op;
    std::string_view content;
    std::size_t start;  ///< in what was read
};

std::vector<Record> records_of(std::string_view bytes) {
    std::vector<Record> records;
    Cursor cursor{bytes};
    while (!cursor.rest.empty()) {
        const std::size_t start = bytes.size() - cursor.rest.size();
        const auto op = cursor.number<std::uint8_t>();
        records.push_back({op, cursor.bytes(cursor.size()), start});
    }
    return records;
}

std::uint32_t crc_of(std::string_view bytes) {
    const std::vector<Bytef> copy(bytes.begin(), bytes.end());
    return static_cast<std::uint32_t>(::crc32_z(0, copy.data(), copy.size()));
}

struct ReadMessage {
    std::uint16_t channel;
    std::uint32_t sequence;
    std::uint64_t log_ns;
    std::uint64_t publish_ns;
    std::string data;
};

/// The records of a chunk, whose checksum is held against them.
std::string unpacked(std::string_view chunk) {
    Cursor cursor{chunk};
    cursor.bytes(16);
    std::string records(cursor.size(), '\0');
    const auto crc = cursor.number<std::uint32_t>();
    CHECK(cursor.text() == "zstd");
    const std::string_view packed = cursor.bytes(cursor.size());
    CHECK(ZSTD_decompress(records.data(), records.size(), packed.data(), packed.size()) == records.size());
    CHECK(crc_of(records) == crc);
    return records;
}

std::vector<ReadMessage> messages_of(const std::string& chunk) {
    std::vector<ReadMessage> messages;
    for (const Record& record : records_of(chunk)) {
        if (record.op == 5) {
            Cursor c{record.content};
            const auto channel = c.number<std::uint16_t>();
            const auto sequence = c.number<std::uint32_t>();
            const auto log_ns = c.number<std::uint64_t>();
            const auto publish_ns = c.number<std::uint64_t>();
            messages.push_back({channel, sequence, log_ns, publish_ns, std::string(c.rest)});
        }
    }
    return messages;
}

const std::vector<ChannelInfo> kChannels{{.topic = "/a", .schema_name = "A", .schema = "{}"},
                                         {.topic = "/b", .schema_name = "B", .schema = R"({"type":"object"})"}};

std::string noise(std::size_t size, std::uint32_t seed) {
    std::string bytes(size, '\0');
    for (char& c : bytes) {
        seed = seed * 1664525U + 1013904223U;
        c = static_cast<char>(seed >> 24U);
    }
    return bytes;
}

}  // namespace

TEST_CASE("mcap: header, chunks, index and checksums are what the format says, messages come back as they were") {
    const Scratch scratch;
    const auto file = scratch / "run.mcap";
    McapWriter writer(file, kChannels);
    std::vector<std::string> written;
    for (std::uint32_t i = 0; i < 30; ++i) {
        written.push_back(noise(100'000, i));
        writer.write(i % 3 == 0 ? 1 : 0, {.stamp_ns = 1000 + i, .data = written.back()});
    }
    CHECK(writer.messages() == 30);
    CHECK_FALSE(std::filesystem::exists(file));  // not half a file
    writer.finish();

    const std::string bytes = content_of(file);
    const std::string_view magic = mcap::kMagic;
    REQUIRE(bytes.starts_with(magic));
    REQUIRE(bytes.ends_with(magic));
    const std::string_view body = std::string_view(bytes).substr(8, bytes.size() - 16);
    const std::vector<Record> records = records_of(body);
    CHECK(records.front().op == 1);
    CHECK(records.back().op == 2);

    std::vector<ReadMessage> messages;
    std::size_t chunks = 0;
    std::size_t data_end = 0;
    for (const Record& record : records) {
        if (record.op == 6) {
            ++chunks;
            const std::string chunk = unpacked(record.content);
            CHECK(chunk.size() < McapWriter::kChunkBytes + 200'000);
            for (const ReadMessage& message : messages_of(chunk)) {
                messages.push_back(message);
            }
        } else if (record.op == 7) {
            // The index of the chunk before: each entry is a message of the channel.
            CHECK(data_end == 0);
        } else if (record.op == 0x0F) {
            data_end = record.start + 8;
            CHECK(Cursor{record.content}.number<std::uint32_t>() == crc_of(bytes.substr(0, data_end)));
        }
    }
    CHECK(chunks >= 3);
    REQUIRE(messages.size() == written.size());
    std::map<std::uint16_t, std::uint32_t> sequence;
    for (std::size_t i = 0; i < messages.size(); ++i) {
        CHECK(messages[i].data == written[i]);
        CHECK(messages[i].channel == (i % 3 == 0 ? 2 : 1));
        CHECK(messages[i].log_ns == 1000 + i);
        CHECK(messages[i].sequence == sequence[messages[i].channel]++);
    }

    Cursor footer{records.back().content};
    const std::size_t summary = footer.size();
    const std::size_t offsets = footer.size();
    CHECK(summary > data_end);
    CHECK(offsets > summary);
    const std::size_t end = bytes.size() - 8 - 4;
    CHECK(footer.number<std::uint32_t>() == crc_of(bytes.substr(summary, end - summary)));
    // Each group stands where the summary says.
    std::size_t groups = 0;
    for (const Record& record : records) {
        if (record.op == 0x0E) {
            Cursor group{record.content};
            const auto op = group.number<std::uint8_t>();
            const std::size_t start = group.size();
            const std::size_t length = group.size();
            for (const Record& one : records_of(std::string_view(bytes).substr(start, length))) {
                CHECK(one.op == op);
            }
            ++groups;
        }
    }
    CHECK(groups == 4);
}

TEST_CASE("mcap: the index of a chunk leads to each of its messages") {
    const Scratch scratch;
    McapWriter writer(scratch / "run.mcap", kChannels);
    for (int i = 0; i < 10; ++i) {
        writer.write(i < 7 ? 0 : 1, {.stamp_ns = std::int64_t{5} * i, .data = "{}"});
    }
    writer.finish();
    const std::string bytes = content_of(scratch / "run.mcap");
    const std::vector<Record> records = records_of(std::string_view(bytes).substr(8, bytes.size() - 16));
    std::string chunk;
    std::map<std::uint16_t, std::size_t> found;
    for (const Record& record : records) {
        if (record.op == 6) {
            chunk = unpacked(record.content);
        } else if (record.op == 7) {
            Cursor index{record.content};
            const auto channel = index.number<std::uint16_t>();
            Cursor entries{index.text()};
            while (!entries.rest.empty()) {
                const auto time_ns = entries.number<std::uint64_t>();
                const std::size_t offset = entries.size();
                const ReadMessage message = messages_of(chunk.substr(offset)).front();
                CHECK(message.channel == channel);
                CHECK(message.log_ns == time_ns);
                ++found[channel];
            }
        } else if (record.op == 8) {
            Cursor place{record.content};
            CHECK(place.number<std::uint64_t>() == 0);
            CHECK(place.number<std::uint64_t>() == 45);
            const std::size_t start = place.size();
            CHECK(static_cast<std::uint8_t>(bytes.at(start)) == 6);
            const std::size_t length = place.size();
            CHECK(static_cast<std::uint8_t>(bytes.at(start + length)) == 7);
        }
    }
    CHECK(found == std::map<std::uint16_t, std::size_t>{{1, 7}, {2, 3}});
}

TEST_CASE("mcap: time does not run back, whatever the messages say") {
    const Scratch scratch;
    McapWriter writer(scratch / "run.mcap", kChannels);
    for (const std::int64_t stamp_ns : {100, 50, -7, 200}) {
        writer.write(0, {.stamp_ns = stamp_ns, .data = "{}"});
    }
    writer.finish();
    const std::string bytes = content_of(scratch / "run.mcap");
    for (const Record& record : records_of(std::string_view(bytes).substr(8, bytes.size() - 16))) {
        if (record.op == 6) {
            const std::vector<ReadMessage> messages = messages_of(unpacked(record.content));
            REQUIRE(messages.size() == 4);
            CHECK(messages[1].log_ns == 100);
            CHECK(messages[1].publish_ns == 50);
            CHECK(messages[2].log_ns == 100);
            CHECK(messages[2].publish_ns == 0);
            CHECK(messages[3].log_ns == 200);
        }
    }
}

TEST_CASE("mcap: a file without messages is one all the same, one that cannot be written is an error") {
    const Scratch scratch;
    McapWriter writer(scratch / "empty.mcap", kChannels);
    writer.finish();
    const std::string bytes = content_of(scratch / "empty.mcap");
    CHECK(bytes.ends_with(mcap::kMagic));
    CHECK_THROWS_AS(McapWriter(scratch / "no/such/folder.mcap", kChannels), crspf::InputError);
}
