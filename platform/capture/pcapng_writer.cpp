#include "platform/capture/pcapng_writer.hpp"

#include <algorithm>

#include "platform/capture/link_kind.hpp"
#include "platform/capture/pcapng_blocks.hpp"
#include "platform/capture/wire.hpp"

namespace crspf::pcapng {
namespace {

constexpr std::uint8_t kNanoseconds = 9;  // as 10^-9

template <typename T>
void put(std::vector<std::uint8_t>& out, T value) {
    wire::append(out, value, wire::kNative);
}

template <typename Bytes>
void put_padded(std::vector<std::uint8_t>& out, const Bytes& bytes) {
    out.insert(out.end(), bytes.begin(), bytes.end());
    out.insert(out.end(), (4 - bytes.size() % 4) % 4, 0);
}

/// Left out where it is empty.
void put_text(std::vector<std::uint8_t>& out, std::uint16_t option, std::string_view text) {
    if (!text.empty()) {
        put(out, option);
        put(out, static_cast<std::uint16_t>(text.size()));
        put_padded(out, text);
    }
}

std::size_t begin_block(std::vector<std::uint8_t>& out, std::uint32_t type) {
    const std::size_t begin = out.size();
    put(out, type);
    put(out, std::uint32_t{0});  // its length, which end_block() knows
    return begin;
}

void end_options(std::vector<std::uint8_t>& out) {
    put(out, kOptionEnd);
    put(out, std::uint16_t{0});
}

void end_block(std::vector<std::uint8_t>& out, std::size_t begin) {
    const auto length = static_cast<std::uint32_t>(out.size() - begin + sizeof(std::uint32_t));
    put(out, length);
    std::copy(out.end() - sizeof(length), out.end(), out.begin() + static_cast<std::ptrdiff_t>(begin + sizeof(length)));
}

}  // namespace

bool append_section(std::vector<std::uint8_t>& out, std::string_view comment) {
    if (comment.size() > kTextMax) {
        return false;
    }
    const std::size_t begin = begin_block(out, kSectionHeader);
    put(out, kByteOrderMagic);
    put(out, std::uint16_t{1});  // version 1.0
    put(out, std::uint16_t{0});
    put(out, ~std::uint64_t{0});  // length of the section: not known
    put_text(out, kOptionComment, comment);
    put_text(out, kOptionSectionProgram, "crspf");
    end_options(out);
    end_block(out, begin);
    return true;
}

bool append_source(std::vector<std::uint8_t>& out, const CaptureSource& source) {
    if (source.link == LinkKind::kOther || source.name.size() > kTextMax || source.description.size() > kTextMax) {
        return false;
    }
    const std::size_t begin = begin_block(out, kInterface);
    put(out, link_type_of(source.link));
    put(out, std::uint16_t{0});
    put(out, std::uint32_t{CaptureRecord::kBytesMax});
    put_text(out, kOptionInterfaceName, source.name);
    put_text(out, kOptionInterfaceDescription, source.description);
    put(out, kOptionInterfaceResolution);
    put(out, std::uint16_t{1});
    out.insert(out.end(), {kNanoseconds, 0, 0, 0});
    end_options(out);
    end_block(out, begin);
    return true;
}

bool append_record(std::vector<std::uint8_t>& out, const CaptureRecord& record) {
    if (record.bytes.size() > CaptureRecord::kBytesMax || record.stamp.ns < 0) {
        return false;
    }
    const std::size_t begin = begin_block(out, kEnhancedPacket);
    const auto ticks = static_cast<std::uint64_t>(record.stamp.ns);
    const auto size = static_cast<std::uint32_t>(record.bytes.size());
    put(out, record.source);
    put(out, static_cast<std::uint32_t>(ticks >> 32U));
    put(out, static_cast<std::uint32_t>(ticks));
    put(out, size);
    put(out, record.cut ? size + 1 : size);  // how much is missing is not known, only that something is
    put_padded(out, record.bytes);
    if (record.direction != Direction::kUnknown) {
        put(out, kOptionPacketFlags);
        put(out, std::uint16_t{sizeof(std::uint32_t)});
        put(out, record.direction == Direction::kReceived ? kFlagsReceived : kFlagsSent);
        end_options(out);
    }
    end_block(out, begin);
    return true;
}

}  // namespace crspf::pcapng
