// Recordings made and read in tests.
#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "platform/capture/capture_reader.hpp"
#include "platform/capture/wire.hpp"

namespace crspf::test {

using Bytes = std::vector<std::uint8_t>;

inline std::string text_of(std::span<const std::uint8_t> bytes) {
    return {bytes.begin(), bytes.end()};
}

inline Bytes bytes_of(std::string_view text) {
    return {text.begin(), text.end()};
}

/// A record with bytes of its own.
struct KeptRecord {
    CaptureRecord record;
    std::string bytes;
};

struct ReadCapture {
    std::vector<KeptRecord> records;
    std::vector<CaptureSource> sources;
    std::string comment;
    std::string format;
    CaptureCounts counts;
};

inline ReadCapture read_capture(const std::filesystem::path& file) {
    ReadCapture read;
    const auto reader = open_capture(file);
    for (CaptureRecord record; reader->next(record);) {
        read.records.push_back({record, text_of(record.bytes)});
    }
    read.sources = reader->sources();
    read.comment = reader->comment();
    read.format = reader->format();
    read.counts = reader->counts();
    return read;
}

/// Blocks of a pcapng file written field by field, in either byte order.
class BlockMaker {
 public:
    explicit BlockMaker(wire::Order order) : order_(order) {}

    template <typename T>
    BlockMaker& put(T value) {
        wire::append(body_, value, order_);
        return *this;
    }
    BlockMaker& put_bytes(std::string_view bytes) {
        body_.insert(body_.end(), bytes.begin(), bytes.end());
        body_.insert(body_.end(), (4 - bytes.size() % 4) % 4, 0);
        return *this;
    }
    BlockMaker& option(std::uint16_t code, std::string_view value) {
        return put(code).put(static_cast<std::uint16_t>(value.size())).put_bytes(value);
    }
    std::string block(std::uint32_t type) {
        Bytes out;
        const auto length = static_cast<std::uint32_t>(body_.size() + 12);
        wire::append(out, type, order_);
        wire::append(out, length, order_);
        out.insert(out.end(), body_.begin(), body_.end());
        wire::append(out, length, order_);
        body_.clear();
        return text_of(out);
    }

 private:
    wire::Order order_;
    Bytes body_;
};

}  // namespace crspf::test
