// The records of an MCAP file (mcap.dev/spec, version 0), as bytes.
#pragma once

#include <concepts>
#include <cstdint>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "tools/view/channels.hpp"

namespace crspf::view::mcap {

inline constexpr std::string_view kMagic{"\x89MCAP0\r\n", 8};

enum class Op : std::uint8_t {
    kHeader = 0x01,
    kFooter = 0x02,
    kSchema = 0x03,
    kChannel = 0x04,
    kMessage = 0x05,
    kChunk = 0x06,
    kMessageIndex = 0x07,
    kChunkIndex = 0x08,
    kStatistics = 0x0B,
    kSummaryOffset = 0x0E,
    kDataEnd = 0x0F,
};

/// Little-endian, as all of the format.
template <std::unsigned_integral T>
void append(std::string& out, T value) {
    for (std::size_t i = 0; i < sizeof(T); ++i) {
        out += static_cast<char>(std::uint64_t{value} >> (8 * i));
    }
}
void append_text(std::string& out, std::string_view text);
void append_record(std::string& out, Op op, std::string_view content);

/// CRC-32 of `bytes`, going on from that of what stands before them.
[[nodiscard]] std::uint32_t crc(std::string_view bytes, std::uint32_t before = 0);

/// Where a message lies in its chunk.
struct MessagePlace {
    std::uint64_t time_ns = 0;
    std::uint64_t offset = 0;
};

/// What the index says of a chunk.
struct ChunkPlace {
    std::uint64_t first_ns = 0;
    std::uint64_t last_ns = 0;
    std::uint64_t start = 0;  ///< in the file
    std::uint64_t length = 0;
    std::vector<std::pair<std::uint16_t, std::uint64_t>> indexes;  ///< channel, where its messages' index stands
    std::uint64_t indexes_length = 0;
    std::uint64_t compressed = 0;
    std::uint64_t uncompressed = 0;
};

struct FileStatistics {
    std::uint64_t messages = 0;
    std::uint32_t chunks = 0;
    std::uint64_t first_ns = 0;
    std::uint64_t last_ns = 0;
    std::vector<std::uint64_t> of_channel;
};

/// Schemas and channels, numbered from 1, each with its own.
[[nodiscard]] std::string schema_records(const std::vector<ChannelInfo>& channels);
[[nodiscard]] std::string channel_records(const std::vector<ChannelInfo>& channels);
[[nodiscard]] std::string message_record(std::uint16_t channel, std::uint32_t sequence, std::uint64_t time_ns,
                                         const Message& message);
/// Compressed by zstd.
[[nodiscard]] std::string chunk_record(std::string_view records, ChunkPlace& place);
[[nodiscard]] std::string message_index_record(std::uint16_t channel, const std::vector<MessagePlace>& places);
[[nodiscard]] std::string chunk_index_record(const ChunkPlace& chunk);
[[nodiscard]] std::string statistics_record(const FileStatistics& statistics);

}  // namespace crspf::view::mcap
