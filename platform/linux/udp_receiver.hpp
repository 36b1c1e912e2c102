// Datagrams of one sensor.
#pragma once

#include <cstdint>

#include "platform/linux/reopening_fd.hpp"
#include "platform/linux/socket_message.hpp"
#include "platform/ports/datagram_source.hpp"

namespace crspf {

/// Addresses are IPv4, as numbers; 0: any.
struct UdpReceiverParams {
    std::uint32_t own_address = 0;  ///< the network to listen on; need not be there yet
    std::uint16_t port = 0;
    std::uint32_t source_address = 0;  ///< the sensor: others' datagrams are refused
    int buffer_bytes = 1 << 20;        ///< [bytes] of the kernel's queue; it grants up to net.core.rmem_max
};

/// Counters never fall.
struct UdpCounters {
    std::uint64_t received = 0;
    std::uint64_t refused = 0;  ///< of others
    std::uint64_t truncated = 0;
    std::uint64_t dropped = 0;  ///< by the kernel: nobody fetched them in time
};

class UdpReceiver final : public DatagramSource {
 public:
    explicit UdpReceiver(const UdpReceiverParams& params) : params_(params) {}

    [[nodiscard]] Datagram receive(std::span<std::uint8_t> into, Duration wait) override;

    [[nodiscard]] const UdpCounters& counters() const { return counters_; }
    /// errno of why it is closed; EADDRINUSE: another process listens there.
    [[nodiscard]] int error() const override { return fd_.error(); }

 private:
    bool open(Duration wait);

    UdpReceiverParams params_;
    ReopeningFd fd_;
    MessageReceiver messages_;
    UdpCounters counters_;
    std::uint32_t dropped_ = 0;  ///< since the last result
};

}  // namespace crspf
