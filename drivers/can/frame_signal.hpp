// A signal together with the frames that carry it.
#pragma once

#include <array>
#include <cstdint>
#include <optional>

#include "core/base/can_frame.hpp"
#include "drivers/can/can_signal.hpp"

namespace crspf {

/// Which bits of a J1939 id name the parameter group of a broadcast (PDU2): neither priority nor source address.
inline constexpr std::uint32_t kJ1939PgnMask = 0x03FFFF00;

struct FrameSignal {
    /// The signal is in the frame while the selector is within one of the ranges.
    struct Range {
        std::uint64_t low = 0;
        std::uint64_t high = 0;
    };

    std::uint32_t id = 0;
    std::uint32_t id_mask = 0x1FFFFFFF;  ///< bits of the id that count
    bool extended = false;
    CanSignal layout;
    CanSignal selector;  ///< meaningful where there are ranges
    std::uint8_t range_count = 0;
    std::array<Range, 8> ranges{};
};

/// Whether the frame's id is the signal's. Error and remote frames carry nothing.
[[nodiscard]] bool addressed(const FrameSignal& signal, const CanFrame& frame);
/// The signal's bits in the frame; nothing where the frame does not carry them, or is too short to.
[[nodiscard]] std::optional<std::uint64_t> bits_in(const FrameSignal& signal, const CanFrame& frame);
/// Its value, likewise.
[[nodiscard]] std::optional<double> value_in(const FrameSignal& signal, const CanFrame& frame);

}  // namespace crspf
