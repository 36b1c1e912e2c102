#include "platform/linux/can_link.hpp"

#include <linux/can/netlink.h>
#include <linux/rtnetlink.h>
#include <net/if.h>
#include <net/if_arp.h>

#include <algorithm>
#include <array>
#include <catch2/catch.hpp>
#include <cerrno>
#include <cstring>
#include <iterator>
#include <vector>

using crspf::CanLink;
using crspf::parse_can_link;
using crspf::read_can_link;

namespace {

using Bytes = std::vector<std::uint8_t>;

template <typename Plain>
void append(Bytes& to, const Plain& value) {
    std::array<std::uint8_t, sizeof(value)> bytes{};
    std::memcpy(bytes.data(), &value, sizeof(value));
    std::copy(bytes.begin(), bytes.end(), std::back_inserter(to));
}

Bytes attribute(int type, const Bytes& content) {
    Bytes bytes;
    append(bytes, rtattr{.rta_len = static_cast<unsigned short>(sizeof(rtattr) + content.size()),
                         .rta_type = static_cast<unsigned short>(type)});
    std::copy(content.begin(), content.end(), std::back_inserter(bytes));
    bytes.resize((bytes.size() + 3) / 4 * 4);
    return bytes;
}

template <typename Plain>
Bytes plain(const Plain& value) {
    Bytes bytes;
    append(bytes, value);
    return bytes;
}

Bytes operator+(Bytes a, const Bytes& b) {
    std::copy(b.begin(), b.end(), std::back_inserter(a));
    return a;
}

Bytes message(std::uint16_t type, const Bytes& body) {
    Bytes bytes;
    nlmsghdr head{};
    head.nlmsg_len = static_cast<std::uint32_t>(sizeof(head) + body.size());
    head.nlmsg_type = type;
    append(bytes, head);
    return bytes + body;
}

/// What the kernel says of can0: up, 500 kbit/s, error-passive, restart after 100 ms.
Bytes can0(unsigned short device = ARPHRD_CAN) {
    ifinfomsg info{};
    info.ifi_type = device;
    info.ifi_flags = IFF_UP;
    can_bittiming timing{};
    timing.bitrate = 500'000;
    const std::uint32_t state = CAN_STATE_ERROR_PASSIVE;
    const Bytes data = attribute(IFLA_CAN_BITTIMING, plain(timing)) + attribute(IFLA_CAN_STATE, plain(state)) +
                       attribute(IFLA_CAN_RESTART_MS, plain(std::uint32_t{100}));
    // The name has five bytes with its zero: what follows is padded.
    return message(RTM_NEWLINK,
                   plain(info) + attribute(IFLA_IFNAME, Bytes{'c', 'a', 'n', '0', 0}) +
                       attribute(IFLA_LINKINFO | NLA_F_NESTED,
                                 attribute(IFLA_INFO_KIND, Bytes{'c', 'a', 'n', 0}) + attribute(IFLA_INFO_DATA, data)));
}

}  // namespace

TEST_CASE("can link: bit rate, restart and state of a controller") {
    CanLink link;
    REQUIRE(parse_can_link(can0(), link) == 0);
    CHECK(link.is_can);
    CHECK(link.up);
    CHECK(link.controller);
    CHECK(link.bitrate_hz == 500'000);
    CHECK(link.restart_ms == 100);
    CHECK(link.state == CAN_STATE_ERROR_PASSIVE);
}

TEST_CASE("can link: attributes of an interface of another kind mean something else") {
    CanLink link;
    REQUIRE(parse_can_link(can0(ARPHRD_ETHER), link) == 0);
    CHECK_FALSE(link.is_can);
    CHECK_FALSE(link.controller);
    CHECK(link.bitrate_hz == 0);
}

TEST_CASE("can link: the kernel's refusal is its errno") {
    nlmsgerr refusal{};
    refusal.error = -ENODEV;
    CanLink link;
    CHECK(parse_can_link(message(NLMSG_ERROR, plain(refusal)), link) == ENODEV);
}

TEST_CASE("can link: an answer cut anywhere is refused or tells less, and is not read beyond its end") {
    const Bytes whole = can0();
    for (std::size_t size = 0; size < whole.size(); ++size) {
        CAPTURE(size);
        const Bytes cut(whole.begin(), whole.begin() + static_cast<std::ptrdiff_t>(size));  // its own memory: asan sees
        CanLink link;
        CHECK(parse_can_link(cut, link) == EBADMSG);
        // The same, with a length that agrees.
        if (size >= sizeof(nlmsghdr)) {
            Bytes shorter = cut;
            shorter[0] = static_cast<std::uint8_t>(size & 0xFFU);
            shorter[1] = static_cast<std::uint8_t>(size >> 8U);
            const int error = parse_can_link(shorter, link);
            CHECK((error == EBADMSG) == (size < sizeof(nlmsghdr) + sizeof(ifinfomsg)));
            CHECK(link.restart_ms == 0);  // stands last, in an attribute that is not whole
        }
    }
    Bytes endless = whole;
    endless[sizeof(nlmsghdr) + sizeof(ifinfomsg)] = 0;  // an attribute of no length
    endless[sizeof(nlmsghdr) + sizeof(ifinfomsg) + 1] = 0;
    CanLink link;
    CHECK(parse_can_link(endless, link) == 0);
    CHECK_FALSE(link.controller);
}

TEST_CASE("can link: the kernel of this machine answers") {
    CanLink link;
    CHECK(read_can_link("nocan0", link) == ENODEV);
    CHECK(read_can_link("a name that is longer than any interface's", link) == ENODEV);
    if (::if_nametoindex("lo") == 0) {
        WARN("skipped: no interface lo here");
        return;
    }
    REQUIRE(read_can_link("lo", link) == 0);
    CHECK_FALSE(link.is_can);
}
