// One frame of a CAN bus, classic or FD, as any adapter, log or simulator hands it over.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

namespace crspf {

struct CanFrame {
    static constexpr std::size_t kBytesMax = 64;  ///< CAN FD; 8 in a classic frame

    std::uint32_t id = 0;   ///< 11 bits, 29 if `extended`; of an error frame the class of the error
    bool extended = false;  ///< 29-bit identifier
    bool remote = false;    ///< asks for a frame: `length` is what it asks for, there are no data
    bool error = false;     ///< made by the controller, about the bus
    bool fd = false;
    std::uint8_t fd_flags = 0;  ///< CAN FD only: 1 bit rate switch, 2 error state indicator, as SocketCAN has them
    std::uint8_t length = 0;    ///< [bytes] in use
    std::array<std::uint8_t, kBytesMax> data{};

    [[nodiscard]] std::span<const std::uint8_t> payload() const { return std::span(data).first(remote ? 0 : length); }
    friend bool operator==(const CanFrame&, const CanFrame&) = default;
};

/// Whether a bus can carry it: identifier and length within the bounds of its kind.
[[nodiscard]] constexpr bool is_valid(const CanFrame& frame) {
    const std::uint32_t id_max = frame.extended || frame.error ? 0x1FFFFFFFU : 0x7FFU;
    const std::size_t length_max = frame.fd ? CanFrame::kBytesMax : 8;
    return frame.id <= id_max && frame.length <= length_max && !(frame.fd && frame.remote);
}

}  // namespace crspf
