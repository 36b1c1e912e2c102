#include "tools/view/mcap_records.hpp"

#include <zlib.h>
#include <zstd.h>

#include <algorithm>
#include <stdexcept>

namespace crspf::view::mcap {
namespace {

constexpr std::string_view kCompression = "zstd";
constexpr int kCompressionLevel = 3;

std::string record(Op op, const std::string& content) {
    std::string out;
    append_record(out, op, content);
    return out;
}

std::uint16_t id_of(std::size_t place) {
    return static_cast<std::uint16_t>(place + 1);
}

std::string compressed(std::string_view bytes) {
    std::string out(ZSTD_compressBound(bytes.size()), '\0');
    const std::size_t size = ZSTD_compress(out.data(), out.size(), bytes.data(), bytes.size(), kCompressionLevel);
    if (ZSTD_isError(size) != 0U) {
        throw std::runtime_error(std::string("zstd: ") + ZSTD_getErrorName(size));
    }
    out.resize(size);
    return out;
}

}  // namespace

void append_text(std::string& out, std::string_view text) {
    append(out, static_cast<std::uint32_t>(text.size()));
    out += text;
}

void append_record(std::string& out, Op op, std::string_view content) {
    append(out, static_cast<std::uint8_t>(op));
    append(out, std::uint64_t{content.size()});
    out += content;
}

std::uint32_t crc(std::string_view bytes, std::uint32_t before) {
    // NOLINTNEXTLINE(cppcoreguidelines-pro-type-reinterpret-cast): characters as the bytes that zlib takes
    const auto* const data = reinterpret_cast<const Bytef*>(bytes.data());
    return static_cast<std::uint32_t>(::crc32_z(before, data, bytes.size()));
}

std::string schema_records(const std::vector<ChannelInfo>& channels) {
    std::string out;
    for (std::size_t i = 0; i < channels.size(); ++i) {
        std::string content;
        append(content, id_of(i));
        append_text(content, channels[i].schema_name);
        append_text(content, "jsonschema");
        append_text(content, channels[i].schema);
        append_record(out, Op::kSchema, content);
    }
    return out;
}

std::string channel_records(const std::vector<ChannelInfo>& channels) {
    std::string out;
    for (std::size_t i = 0; i < channels.size(); ++i) {
        std::string content;
        append(content, id_of(i));
        append(content, id_of(i));
        append_text(content, channels[i].topic);
        append_text(content, "json");
        append_text(content, "");  // no metadata
        append_record(out, Op::kChannel, content);
    }
    return out;
}

std::string message_record(std::uint16_t channel, std::uint32_t sequence, std::uint64_t time_ns,
                           const Message& message) {
    std::string content;
    append(content, channel);
    append(content, sequence);
    append(content, time_ns);
    append(content, static_cast<std::uint64_t>(std::max<std::int64_t>(message.stamp_ns, 0)));
    content += message.data;
    return record(Op::kMessage, content);
}

std::string chunk_record(std::string_view records, ChunkPlace& place) {
    const std::string packed = compressed(records);
    place.compressed = packed.size();
    place.uncompressed = records.size();
    std::string content;
    append(content, place.first_ns);
    append(content, place.last_ns);
    append(content, place.uncompressed);
    append(content, crc(records));
    append_text(content, kCompression);
    append(content, place.compressed);
    content += packed;
    return record(Op::kChunk, content);
}

std::string message_index_record(std::uint16_t channel, const std::vector<MessagePlace>& places) {
    std::string entries;
    for (const MessagePlace& place : places) {
        append(entries, place.time_ns);
        append(entries, place.offset);
    }
    std::string content;
    append(content, channel);
    append_text(content, entries);
    return record(Op::kMessageIndex, content);
}

std::string chunk_index_record(const ChunkPlace& chunk) {
    std::string indexes;
    for (const auto& [channel, start] : chunk.indexes) {
        append(indexes, channel);
        append(indexes, start);
    }
    std::string content;
    for (const std::uint64_t value : {chunk.first_ns, chunk.last_ns, chunk.start, chunk.length}) {
        append(content, value);
    }
    append_text(content, indexes);
    append(content, chunk.indexes_length);
    append_text(content, kCompression);
    append(content, chunk.compressed);
    append(content, chunk.uncompressed);
    return record(Op::kChunkIndex, content);
}

std::string statistics_record(const FileStatistics& statistics) {
    std::string counts;
    for (std::size_t i = 0; i < statistics.of_channel.size(); ++i) {
        append(counts, id_of(i));
        append(counts, statistics.of_channel[i]);
    }
    const auto channels = static_cast<std::uint32_t>(statistics.of_channel.size());
    std::string content;
    append(content, statistics.messages);
    append(content, static_cast<std::uint16_t>(channels));  // schemas
    append(content, channels);
    append(content, std::uint32_t{0});  // attachments
    append(content, std::uint32_t{0});  // metadata
    append(content, statistics.chunks);
    append(content, statistics.first_ns);
    append(content, statistics.last_ns);
    append_text(content, counts);
    return record(Op::kStatistics, content);
}

}  // namespace crspf::view::mcap
