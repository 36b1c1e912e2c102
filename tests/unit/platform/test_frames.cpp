#include "platform/capture/frames.hpp"

#include <algorithm>
#include <catch2/catch.hpp>
#include <cstdint>
#include <string>
#include <vector>

#include "tests/unit/platform/captures.hpp"

using crspf::append_can_frame;
using crspf::append_udp_frame;
using crspf::CanFrame;
using crspf::FrameContent;
using crspf::LinkKind;
using crspf::UdpDatagram;
using crspf::test::Bytes;
using crspf::test::bytes_of;
using crspf::test::text_of;

namespace {

/// Written out by hand: 192.168.1.201:2368 to 255.255.255.255:2369, payload "hello", padded as Ethernet does.
Bytes hello() {
    Bytes frame{0xFF, 0xFF, 0xFF, 0xFF, 0xFF, 0xFF, 0x60, 0x76, 0x88, 0x10, 0x2F, 0x6F, 0x08, 0x00,  //
                0x45, 0x00, 0x00, 0x21, 0x00, 0x00, 0x40, 0x00, 0xFF, 0x11, 0x00, 0x00,              //
                0xC0, 0xA8, 0x01, 0xC9, 0xFF, 0xFF, 0xFF, 0xFF,                                      //
                0x09, 0x40, 0x09, 0x41, 0x00, 0x0D, 0x00, 0x00, 'h',  'e',  'l',  'l',  'o'};
    frame.resize(60);
    return frame;
}

void check_hello(LinkKind link, const Bytes& frame) {
    UdpDatagram datagram;
    REQUIRE(udp_of(link, frame, datagram) == FrameContent::kFound);
    CHECK(datagram.source_address == 0xC0A801C9);
    CHECK(datagram.destination_address == 0xFFFFFFFF);
    CHECK(datagram.source_port == 2368);
    CHECK(datagram.destination_port == 2369);
    CHECK(text_of(datagram.payload) == "hello");
}

FrameContent content(LinkKind link, const Bytes& frame) {
    UdpDatagram datagram;
    return udp_of(link, frame, datagram);
}

Bytes inserted(Bytes frame, std::ptrdiff_t at, const Bytes& what) {
    frame.insert(frame.begin() + at, what.begin(), what.end());
    return frame;
}

}  // namespace

TEST_CASE("frames: a datagram under every header") {
    const Bytes frame = hello();
    check_hello(LinkKind::kEthernet, frame);
    check_hello(LinkKind::kEthernet, inserted(frame, 12, {0x81, 0x00, 0x00, 0x05}));
    check_hello(LinkKind::kEthernet, inserted(frame, 12, {0x88, 0xA8, 0x00, 0x05, 0x81, 0x00, 0x00, 0x07}));
    const Bytes packet(frame.begin() + 14, frame.end());
    check_hello(LinkKind::kRawIp, packet);
    check_hello(LinkKind::kLinuxCooked, inserted(packet, 0, {0, 0, 0, 1, 0, 6, 1, 2, 3, 4, 5, 6, 0, 0, 0x08, 0x00}));
    check_hello(LinkKind::kLinuxCooked2,
                inserted(packet, 0, {0x08, 0x00, 0, 0, 0, 0, 0, 2, 0, 1, 0, 6, 1, 2, 3, 4, 5, 6, 0, 0}));
    Bytes options = inserted(frame, 34, {0x94, 0x04, 0x00, 0x00});  // router alert
    options[14] = 0x46;
    options[17] = 0x25;
    check_hello(LinkKind::kEthernet, options);
}

TEST_CASE("frames: what is no whole datagram is told apart") {
    const auto changed = [](std::size_t at, std::uint8_t value) {
        Bytes frame = hello();
        frame[at] = value;
        return frame;
    };
    CHECK(content(LinkKind::kEthernet, changed(13, 0x06)) == FrameContent::kOther);     // ARP
    CHECK(content(LinkKind::kEthernet, changed(23, 6)) == FrameContent::kOther);        // TCP
    CHECK(content(LinkKind::kEthernet, changed(14, 0x65)) == FrameContent::kOther);     // IPv6
    CHECK(content(LinkKind::kEthernet, changed(20, 0x20)) == FrameContent::kFragment);  // more to come
    CHECK(content(LinkKind::kEthernet, changed(21, 0x10)) == FrameContent::kFragment);  // not the first
    CHECK(content(LinkKind::kEthernet, changed(14, 0x44)) == FrameContent::kDamaged);   // a header of 16 bytes
    CHECK(content(LinkKind::kEthernet, changed(17, 60)) == FrameContent::kDamaged);     // longer than the frame
    CHECK(content(LinkKind::kEthernet, changed(17, 27)) == FrameContent::kDamaged);     // no room for UDP
    CHECK(content(LinkKind::kEthernet, changed(39, 14)) == FrameContent::kDamaged);     // longer than the packet
    CHECK(content(LinkKind::kEthernet, changed(39, 7)) == FrameContent::kDamaged);
    CHECK(content(LinkKind::kCan, hello()) == FrameContent::kOther);
    CHECK(content(LinkKind::kStream, hello()) == FrameContent::kOther);
    const Bytes whole = hello();
    for (std::ptrdiff_t size = 0; size < 47; ++size) {
        CAPTURE(size);
        REQUIRE(content(LinkKind::kEthernet, Bytes(whole.begin(), whole.begin() + size)) == FrameContent::kDamaged);
    }
}

TEST_CASE("frames: a datagram wrapped is found again, its header sum right") {
    const Bytes payload = bytes_of("hello");
    const UdpDatagram datagram{0xC0A801C9, 0xFFFFFFFF, 2368, 2369, payload};
    Bytes frame{0xAA};
    REQUIRE(append_udp_frame(frame, datagram));
    frame.erase(frame.begin());
    check_hello(LinkKind::kEthernet, frame);
    CHECK(frame.size() == 42 + payload.size());  // other readers skip 42 bytes
    std::uint32_t sum = 0;
    for (std::size_t i = 14; i < 34; i += 2) {
        sum += crspf::wire::big<std::uint16_t>(frame, i);
    }
    CHECK((sum & 0xFFFFU) + (sum >> 16U) == 0xFFFF);
    const Bytes longest(65507);
    const Bytes longer(65508);
    CHECK(append_udp_frame(frame, {.payload = longest}));
    const std::size_t size = frame.size();
    CHECK_FALSE(append_udp_frame(frame, {.payload = longer}));
    CHECK(frame.size() == size);
}

TEST_CASE("frames: CAN records by their layout") {
    CanFrame frame;
    const Bytes classic{0x00, 0x00, 0x02, 0x21, 3, 0, 0, 0, 1, 2, 3, 0, 0};  // with padding
    REQUIRE(can_of(LinkKind::kCan, classic, frame) == FrameContent::kFound);
    CHECK((frame.id == 0x221 && !frame.extended && !frame.remote && !frame.error && !frame.fd && frame.length == 3));
    CHECK(text_of(frame.payload()) == "\x01\x02\x03");
    const Bytes extended{0x98, 0xFE, 0xF1, 0x00, 0, 0, 0, 0};
    REQUIRE(can_of(LinkKind::kCan, extended, frame) == FrameContent::kFound);
    CHECK((frame.id == 0x18FEF100 && frame.extended && frame.length == 0));
    const Bytes remote{0x40, 0x00, 0x01, 0x23, 8, 0, 0, 0};
    REQUIRE(can_of(LinkKind::kCan, remote, frame) == FrameContent::kFound);
    CHECK((frame.remote && frame.length == 8 && frame.payload().empty()));
    const Bytes bus_off{0x20, 0x00, 0x00, 0x40, 8, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0};
    REQUIRE(can_of(LinkKind::kCan, bus_off, frame) == FrameContent::kFound);
    CHECK((frame.error && frame.id == 0x40));
    Bytes fd{0x00, 0x00, 0x01, 0x23, 12, 4, 0, 0};
    CHECK(can_of(LinkKind::kCan, fd, frame) == FrameContent::kDamaged);
    fd.resize(20, 7);
    REQUIRE(can_of(LinkKind::kCan, fd, frame) == FrameContent::kFound);
    CHECK((frame.fd && frame.length == 12 && frame.data[11] == 7));
    CHECK(can_of(LinkKind::kCan, {{0, 0, 0x08, 0, 0, 0, 0, 0}}, frame) == FrameContent::kDamaged);  // 12 bits
    CHECK(can_of(LinkKind::kCan, {{0, 0, 0, 1, 0x80, 0, 0, 0}}, frame) == FrameContent::kOther);    // CAN XL
    CHECK(can_of(LinkKind::kCan, {{0, 0, 0, 1, 0, 0, 0}}, frame) == FrameContent::kDamaged);
    CHECK(can_of(LinkKind::kEthernet, hello(), frame) == FrameContent::kOther);
    // Cooked: the identifier as the machine had it.
    Bytes cooked(14);
    cooked.insert(cooked.end(), {0x00, 0x0C, 0x21, 0x02, 0x00, 0x00, 1, 0, 0, 0, 9});
    REQUIRE(can_of(LinkKind::kLinuxCooked, cooked, frame) == FrameContent::kFound);
    CHECK((frame.id == 0x221 && frame.length == 1 && frame.data[0] == 9));
}

TEST_CASE("frames: a CAN frame written is read back") {
    const std::vector<CanFrame> frames{{.id = 0x7FF, .length = 8, .data = {1, 2, 3, 4, 5, 6, 7, 8}},
                                       {.id = 0x1FFFFFFF, .extended = true},
                                       {.id = 1, .remote = true, .length = 4},
                                       {.id = 0x40, .error = true, .length = 8},
                                       {.id = 2, .fd = true, .length = 64, .data = {9}},
                                       {.id = 2, .fd = true, .length = 1, .data = {9}}};
    for (const CanFrame& frame : frames) {
        Bytes bytes;
        REQUIRE(append_can_frame(bytes, frame));
        CanFrame read;
        REQUIRE(can_of(LinkKind::kCan, bytes, read) == FrameContent::kFound);
        CHECK(read == frame);
    }
    Bytes bytes;
    CHECK_FALSE(append_can_frame(bytes, {.id = 0x800}));
    CHECK_FALSE(append_can_frame(bytes, {.length = 9}));
    CHECK_FALSE(append_can_frame(bytes, {.fd = true, .length = 65}));
    CHECK_FALSE(append_can_frame(bytes, {.remote = true, .fd = true}));
    CHECK(bytes.empty());
}
