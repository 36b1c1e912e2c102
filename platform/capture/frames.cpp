#include "platform/capture/frames.hpp"

#include <algorithm>
#include <array>

#include "platform/capture/wire.hpp"

namespace crspf {
namespace {

using Bytes = std::span<const std::uint8_t>;

constexpr std::uint16_t kProtocolIpv4 = 0x0800;
constexpr std::uint16_t kProtocolCan = 0x000C;
constexpr std::uint16_t kProtocolCanFd = 0x000D;
constexpr std::uint16_t kProtocolNone = 0xFFFF;
constexpr std::uint8_t kIpUdp = 17;
constexpr std::size_t kUdpHeader = 8;  // [bytes]
constexpr std::size_t kIpHeader = 20;  // [bytes] without options

constexpr std::size_t kCanHeader = 8;  // [bytes]
constexpr std::uint32_t kCanExtended = 0x80000000;
constexpr std::uint32_t kCanRemote = 0x40000000;
constexpr std::uint32_t kCanError = 0x20000000;
constexpr std::uint32_t kCanIdMask = 0x1FFFFFFF;
constexpr std::uint8_t kCanFdFlags = 7;   // bit-rate switch, error state, and since 2022 "this is FD"
constexpr std::uint8_t kCanFdFormat = 4;  // the last of these
constexpr std::uint8_t kCanXl = 0x80;     // in the place of the length

bool is_vlan(std::uint16_t protocol) {
    return protocol == 0x8100 || protocol == 0x88A8 || protocol == 0x9100;
}

/// What a link frame carries.
struct Packet {
    std::uint16_t protocol = kProtocolNone;  ///< an EtherType, or what Linux uses beside them
    Bytes bytes;
    bool damaged = false;
};

/// A header of `size` bytes with the protocol's number at `at`, and VLAN tags behind it.
Packet behind_header(Bytes frame, std::size_t size, std::size_t at) {
    if (frame.size() < size) {
        return {kProtocolNone, {}, true};
    }
    Packet packet{.protocol = wire::big<std::uint16_t>(frame, at), .bytes = frame.subspan(size)};
    while (is_vlan(packet.protocol)) {
        if (packet.bytes.size() < 4) {
            return {kProtocolNone, {}, true};
        }
        packet.protocol = wire::big<std::uint16_t>(packet.bytes, 2);
        packet.bytes = packet.bytes.subspan(4);
    }
    return packet;
}

Packet packet_of(LinkKind link, Bytes frame) {
    switch (link) {
        case LinkKind::kEthernet: return behind_header(frame, 14, 12);
        case LinkKind::kLinuxCooked: return behind_header(frame, 16, 14);
        case LinkKind::kLinuxCooked2: return behind_header(frame, 20, 0);
        case LinkKind::kRawIp: return {.protocol = kProtocolIpv4, .bytes = frame};
        case LinkKind::kCan:
        case LinkKind::kStream:
        case LinkKind::kJournal:
        case LinkKind::kStereo:
        case LinkKind::kOther: break;
    }
    return {};
}

FrameContent udp_of_ip(Bytes packet, UdpDatagram& datagram) {
    if (packet.empty()) {
        return FrameContent::kDamaged;
    }
    if (packet[0] >> 4U != 4) {
        return FrameContent::kOther;
    }
    const std::size_t header = std::size_t{packet[0] & 0x0FU} * 4;
    if (header < kIpHeader || packet.size() < header) {
        return FrameContent::kDamaged;
    }
    if (packet[9] != kIpUdp) {
        return FrameContent::kOther;
    }
    if ((wire::big<std::uint16_t>(packet, 6) & 0x3FFFU) != 0) {  // more fragments, or not the first
        return FrameContent::kFragment;
    }
    const std::size_t length = wire::big<std::uint16_t>(packet, 2);
    if (length < header + kUdpHeader || length > packet.size()) {
        return FrameContent::kDamaged;
    }
    const Bytes udp = packet.first(length).subspan(header);  // Ethernet pads short frames
    const std::size_t udp_length = wire::big<std::uint16_t>(udp, 4);
    if (udp_length < kUdpHeader || udp_length > udp.size()) {
        return FrameContent::kDamaged;
    }
    datagram = {.source_address = wire::big<std::uint32_t>(packet, 12),
                .destination_address = wire::big<std::uint32_t>(packet, 16),
                .source_port = wire::big<std::uint16_t>(udp, 0),
                .destination_port = wire::big<std::uint16_t>(udp, 2),
                .payload = udp.first(udp_length).subspan(kUdpHeader)};
    return FrameContent::kFound;
}

FrameContent can_of_socket(Bytes bytes, wire::Order id_order, bool fd, CanFrame& frame) {
    if (bytes.size() < kCanHeader) {
        return FrameContent::kDamaged;
    }
    const std::uint8_t length = bytes[4];
    if ((length & kCanXl) != 0) {
        return FrameContent::kOther;
    }
    const auto id = wire::get<std::uint32_t>(bytes, 0, id_order);
    CanFrame found{.id = id & kCanIdMask,
                   .extended = (id & kCanExtended) != 0,
                   .remote = (id & kCanRemote) != 0,
                   .error = (id & kCanError) != 0,
                   .fd = fd || (bytes[5] & kCanFdFlags) != 0 || length > 8,
                   .length = length};
    if (!is_valid(found) || found.payload().size() > bytes.size() - kCanHeader) {
        return FrameContent::kDamaged;
    }
    std::copy_n(bytes.begin() + kCanHeader, found.payload().size(), found.data.begin());
    frame = found;
    return FrameContent::kFound;
}

std::uint16_t ip_check_sum(Bytes header) {
    std::uint32_t sum = 0;
    for (std::size_t i = 0; i + 1 < header.size(); i += 2) {
        sum += wire::big<std::uint16_t>(header, i);
    }
    while (sum > 0xFFFF) {
        sum = (sum & 0xFFFFU) + (sum >> 16U);
    }
    return static_cast<std::uint16_t>(~sum);
}

}  // namespace

FrameContent udp_of(LinkKind link, std::span<const std::uint8_t> frame, UdpDatagram& datagram) {
    const Packet packet = packet_of(link, frame);
    if (packet.damaged) {
        return FrameContent::kDamaged;
    }
    return packet.protocol == kProtocolIpv4 ? udp_of_ip(packet.bytes, datagram) : FrameContent::kOther;
}

FrameContent can_of(LinkKind link, std::span<const std::uint8_t> bytes, CanFrame& frame) {
    if (link == LinkKind::kCan) {
        return can_of_socket(bytes, wire::Order::kBig, false, frame);
    }
    if (link != LinkKind::kLinuxCooked && link != LinkKind::kLinuxCooked2) {
        return FrameContent::kOther;
    }
    const Packet packet = packet_of(link, bytes);
    if (packet.damaged) {
        return FrameContent::kDamaged;
    }
    if (packet.protocol != kProtocolCan && packet.protocol != kProtocolCanFd) {
        return FrameContent::kOther;
    }
    return can_of_socket(packet.bytes, wire::Order::kLittle, packet.protocol == kProtocolCanFd, frame);
}

bool append_udp_frame(std::vector<std::uint8_t>& out, const UdpDatagram& datagram) {
    constexpr std::size_t kPayloadMax = 65535 - kIpHeader - kUdpHeader;
    if (datagram.payload.size() > kPayloadMax) {
        return false;
    }
    const auto put = [&](auto value) { wire::append(out, value, wire::Order::kBig); };
    const auto udp_length = static_cast<std::uint16_t>(kUdpHeader + datagram.payload.size());
    out.insert(out.end(), 12, 0);  // to and from hardware address 0
    put(kProtocolIpv4);
    const std::size_t ip = out.size();
    put(std::uint8_t{0x45});  // version 4, five words of header
    put(std::uint8_t{0});
    put(static_cast<std::uint16_t>(kIpHeader + udp_length));
    put(std::uint32_t{0x4000});  // number 0, not to be fragmented
    put(std::uint8_t{64});
    put(kIpUdp);
    put(std::uint16_t{0});  // check sum, known below
    put(datagram.source_address);
    put(datagram.destination_address);
    const std::uint16_t check_sum = ip_check_sum(Bytes(out).subspan(ip));
    out[ip + 10] = static_cast<std::uint8_t>(check_sum >> 8U);
    out[ip + 11] = static_cast<std::uint8_t>(check_sum);
    put(datagram.source_port);
    put(datagram.destination_port);
    put(udp_length);
    put(std::uint16_t{0});  // check sum: none
    out.insert(out.end(), datagram.payload.begin(), datagram.payload.end());
    return true;
}

bool append_can_frame(std::vector<std::uint8_t>& out, const CanFrame& frame) {
    if (!is_valid(frame)) {
        return false;
    }
    wire::append(out,
                 frame.id | (frame.extended ? kCanExtended : 0) | (frame.remote ? kCanRemote : 0) |
                     (frame.error ? kCanError : 0),
                 wire::Order::kBig);
    out.push_back(frame.length);
    out.push_back(frame.fd ? kCanFdFormat : std::uint8_t{0});
    out.insert(out.end(), 2, 0);
    out.insert(out.end(), frame.payload().begin(), frame.payload().end());
    return true;
}

}  // namespace crspf
