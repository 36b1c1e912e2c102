// One line of a CAN log as candump -l writes it and canplayer reads it: `(1234.567890) can0 123#DEADBEEF`.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>

#include "core/base/can_frame.hpp"
#include "core/base/time.hpp"

namespace crspf {

enum class CanDirection : std::uint8_t { kUnknown, kReceived, kTransmitted };

struct CandumpLine {
    enum class Kind : std::uint8_t {
        kFrame,
        kNothing,  ///< empty
        kDrops,    ///< DROPCOUNT: the recorder itself lost frames here
        kBad,      ///< `column` and `reason` say where and why
    };

    Kind kind = Kind::kNothing;
    Stamp stamp{};                  ///< since the recorder's epoch: the wall clock's, in most logs
    std::string_view interface {};  ///< in the line's memory, at most 21 characters
    CanFrame frame{};
    CanDirection direction = CanDirection::kUnknown;
    std::size_t column = 0;  ///< from 1
    const char* reason = nullptr;
};

/// Reads a line, with its line end or without. Understands 6 and 9 decimals, 11- and 29-bit ids (3 and 8 digits),
/// remote frames (#R, #R4), CAN FD (##), error frames, the direction (R, T) and passes over the raw length (_9) of a
/// full classic frame. No heap, no throw; time linear in the line.
[[nodiscard]] CandumpLine parse_candump_line(std::string_view line);

/// The longest line that format_candump_line() writes. [bytes]
inline constexpr std::size_t kCandumpLineMax = 200;

/// Writes the line without its end: 6 decimals, 9 where the stamp needs them. Gives the number of bytes, 0 where they
/// did not fit, the stamp is negative, the interface has no name, or more than 21 characters, or the frame is none.
[[nodiscard]] std::size_t format_candump_line(const CandumpLine& line, std::span<char> out);

}  // namespace crspf
