// A serial line or a TCP connection, as the owner of a driver sees it.
#pragma once

#include <cstdint>
#include <span>

#include "platform/ports/io_result.hpp"

namespace crspf {

/// One thread's. No call throws, allocates or waits longer than it is told to, and a loop over read() with a wait never
/// spins, connected or not.
class ByteStream {
 public:
    virtual ~ByteStream() = default;
    /// Some bytes, after waiting up to `wait` for the first.
    [[nodiscard]] virtual Received read(std::span<std::uint8_t> into, Duration wait) = 0;
    /// Does not wait. Does not open a closed port: read() does.
    [[nodiscard]] virtual Sent write(std::span<const std::uint8_t> bytes) = 0;
    /// [bit/s] until the port is closed; it opens with the configured one. kOk and nothing done where there is none.
    [[nodiscard]] virtual IoStatus set_baud(std::uint32_t baud) = 0;
    /// Drops the connection, for who knows by the sensor's silence that it is dead.
    virtual void close() = 0;
    /// Why it is closed: the number of the system's error; 0: nothing went wrong yet.
    [[nodiscard]] virtual int error() const = 0;
};

}  // namespace crspf
