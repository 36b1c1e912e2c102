// One frame of a CAN bus, as any adapter, log or simulator hands it over.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

namespace crspf {

/// Classic CAN (up to 8 bytes) or CAN FD (up to 64). Bytes behind `length` are zero.
struct CanFrame {
    std::uint32_t id = 0;       ///< 11 bits, or 29 where `extended`; of an error frame the error class bits
    std::uint8_t length = 0;    ///< [bytes] of data; of a remote frame the length that is asked for
    std::uint8_t fd_flags = 0;  ///< CAN FD only: 1 bit rate switch, 2 error state indicator, as SocketCAN has them
    bool extended = false;      ///< 29-bit id
    bool fd = false;            ///< CAN FD
    bool remote = false;        ///< a request, without data
    bool error = false;         ///< the controller's word about the bus, not a frame from it
    std::array<std::uint8_t, 64> data{};

    [[nodiscard]] std::span<const std::uint8_t> payload() const {
        return {data.data(), remote ? 0U : static_cast<std::size_t>(length)};
    }
    friend bool operator==(const CanFrame&, const CanFrame&) = default;
};

}  // namespace crspf
