// Finds one signal by name in the text of a DBC file.
#pragma once

#include <cstdint>
#include <string_view>

#include "drivers/can/dbc_reader.hpp"
#include "drivers/can/frame_signal.hpp"

namespace crspf {

struct DbcLookup {
    enum class Status : std::uint8_t {
        kFound,
        kBadText,    ///< `error` says where and why
        kNoMessage,  ///< no message of this name
        kNoSignal,   ///< the message has no signal of this name
        kMultiplex,  ///< nested selectors, none at all, or more than 8 ranges: not followed
        kFloat,      ///< said to be a float, of neither 32 nor 64 bits
    };

    Status status = Status::kNoMessage;
    FrameSignal signal;     ///< where found
    std::string_view unit;  ///< as the file has it
    DbcError error;
};

/// Reads the whole text, so that an error in it does not depend on what is looked for. Of two messages, or signals, of
/// one name the first counts. No heap, no throw; time linear in the text.
[[nodiscard]] DbcLookup find_signal(std::string_view text, std::string_view message, std::string_view signal);

}  // namespace crspf
