// A sensor that sends datagrams, as the owner of a driver sees it.
#pragma once

#include <cstdint>
#include <span>

#include "platform/ports/io_result.hpp"

namespace crspf {

struct Datagram {
    Received io;
    std::uint32_t source_address = 0;  ///< IPv4, as a number: 192.168.1.201 is 0xC0A801C9
    std::uint16_t source_port = 0;
};

/// One thread's. No call throws, allocates or waits longer than it is told to; a loop over receive() with a wait never
/// spins.
class DatagramSource {
 public:
    virtual ~DatagramSource() = default;
    /// One datagram, after waiting up to `wait` for it.
    [[nodiscard]] virtual Datagram receive(std::span<std::uint8_t> into, Duration wait) = 0;
    /// Why it is closed: the number of the system's error; 0: nothing went wrong yet.
    [[nodiscard]] virtual int error() const = 0;
};

}  // namespace crspf
