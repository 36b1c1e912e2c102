// A datagram or a frame with what the kernel knows of its arrival.
#pragma once

#include <netinet/in.h>

#include <cstddef>
#include <cstdint>
#include <span>

#include "core/base/time.hpp"

namespace crspf {

struct SocketMessage {
    int error = 0;  ///< errno; 0: received
    std::size_t bytes = 0;
    bool truncated = false;
    Stamp stamp;                ///< of the arrival, on the monotonic clock
    std::uint32_t dropped = 0;  ///< lost by the queue since the message before
    sockaddr_in from{};
};

/// Where `real` of the calendar clock lies on the monotonic one, both read at about the same time. An age below 0 or
/// above a second means that the calendar was set in between: `now_monotonic` then.
[[nodiscard]] Stamp to_monotonic(Stamp real, Stamp now_real, Stamp now_monotonic);

class MessageReceiver {
 public:
    /// Asks the kernel for stamps and drop counts. False, with errno, where it does not know them.
    [[nodiscard]] static bool prepare(int fd);

    /// Does not wait.
    [[nodiscard]] SocketMessage receive(int fd, std::span<std::uint8_t> into);

    /// For a new socket: the kernel counts from 0.
    void restart() { dropped_ = 0; }

 private:
    std::uint32_t dropped_ = 0;  ///< in all, by the kernel
};

}  // namespace crspf
