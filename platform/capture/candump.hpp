// Log files of can-utils' candump: `(1611227134.123456) can0 221#0064000A00000000` a line.
#pragma once

#include <memory>
#include <string_view>

#include "core/base/can_frame.hpp"
#include "platform/capture/capture_reader.hpp"
#include "platform/capture/unpacked_file.hpp"

namespace crspf {

struct CandumpLine {
    Stamp stamp;
    std::string_view interface;  ///< in the line
    CanFrame frame;
    Direction direction = Direction::kUnknown;
};

/// A line without its end. Why it cannot be used, or nullptr: then `line` is filled.
[[nodiscard]] const char* parse_candump_line(std::string_view text, CandumpLine& line);

/// By the first bytes of a content: one of its lines is a frame.
[[nodiscard]] bool looks_like_candump(std::string_view content);

/// A source for each interface, in the order of their first frames; records of LinkKind::kCan.
[[nodiscard]] std::unique_ptr<CaptureReader> open_candump(UnpackedFile file);

}  // namespace crspf
