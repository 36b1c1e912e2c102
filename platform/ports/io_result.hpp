// What comes of asking a port for something.
#pragma once

#include <cstddef>
#include <cstdint>

#include "core/base/time.hpp"

namespace crspf {

enum class IoStatus : std::uint8_t {
    kOk,
    kRetry,   ///< nothing came, or nothing could be sent, within the time given
    kClosed,  ///< not connected. Each loss is told at least once; the port opens itself again, with growing pauses
    kError,   ///< cannot be done, now or later; the connection stays
};

struct Received {
    IoStatus status = IoStatus::kRetry;
    std::size_t bytes = 0;
    Stamp stamp{};  ///< on the monotonic clock: arrival where the system tells it, else the return of the call
    std::uint32_t dropped = 0;  ///< datagrams or frames that the system lost since the result before
    bool truncated = false;     ///< the datagram was longer than the buffer
};

struct Sent {
    IoStatus status = IoStatus::kRetry;
    std::size_t bytes = 0;  ///< taken, from the front
};

}  // namespace crspf
