// The blocks of a pcapng file (draft-ietf-opsawg-pcapng), as pure functions of what they hold.
#pragma once

#include <cstdint>
#include <string_view>
#include <vector>

#include "platform/capture/capture_reader.hpp"

namespace crspf::pcapng {

/// [bytes] What one comment, name or description may hold: the format counts them in 16 bits.
inline constexpr std::size_t kTextMax = 65535;

// Each appends one whole block to `out`. A file is one section, then its sources, numbered from 0 in this order, then
// the records. Blocks are written in this machine's byte order, stamps in nanoseconds. False, and nothing appended,
// where the format cannot hold it.

/// False for a comment of more than kTextMax.
[[nodiscard]] bool append_section(std::vector<std::uint8_t>& out, std::string_view comment);

/// False for a text of more than kTextMax and for LinkKind::kOther.
[[nodiscard]] bool append_source(std::vector<std::uint8_t>& out, const CaptureSource& source);

/// False for more than CaptureRecord::kBytesMax bytes and for a stamp before 0. `link` is the source's, not looked at.
[[nodiscard]] bool append_record(std::vector<std::uint8_t>& out, const CaptureRecord& record);

}  // namespace crspf::pcapng
