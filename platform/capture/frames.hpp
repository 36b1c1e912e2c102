// What a captured frame carries, found by its headers, and such frames made.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/base/can_frame.hpp"
#include "platform/capture/capture_reader.hpp"

namespace crspf {

/// UDP over IPv4. Addresses and ports as numbers: 192.168.1.201 is 0xC0A801C9.
struct UdpDatagram {
    std::uint32_t source_address = 0;
    std::uint32_t destination_address = 0;
    std::uint16_t source_port = 0;
    std::uint16_t destination_port = 0;
    std::span<const std::uint8_t> payload;  ///< in the frame it was found in
};

enum class FrameContent : std::uint8_t {
    kFound,
    kOther,     ///< something else: ARP, TCP, IPv6 ...
    kFragment,  ///< a part of a datagram; they are not put together
    kDamaged,   ///< lengths that contradict each other, or cut off
};

/// The datagram in an Ethernet frame (with or without VLAN tags), an IP packet or a Linux cooked frame.
/// `datagram` is filled for kFound only. Check sums are not looked at: captures on the sender's side lack them.
[[nodiscard]] FrameContent udp_of(LinkKind link, std::span<const std::uint8_t> frame, UdpDatagram& datagram);

/// The frame in a CAN record or a Linux cooked frame. CAN XL is kOther. `frame` is filled for kFound only. A cooked
/// frame holds the identifier in the byte order of the machine that captured it: taken as little-endian.
[[nodiscard]] FrameContent can_of(LinkKind link, std::span<const std::uint8_t> bytes, CanFrame& frame);

/// Appends an Ethernet frame as it could have been captured: for a datagram that a socket delivered without its
/// headers. Hardware addresses are 0, the UDP check sum is left out. False, and nothing appended, for a payload that is
/// longer than a datagram can be.
[[nodiscard]] bool append_udp_frame(std::vector<std::uint8_t>& out, const UdpDatagram& datagram);

/// Appends the bytes of a record of LinkKind::kCan. False, and nothing appended, unless is_valid(frame).
[[nodiscard]] bool append_can_frame(std::vector<std::uint8_t>& out, const CanFrame& frame);

}  // namespace crspf
