#include "platform/linux/can_link.hpp"

#include <linux/can/netlink.h>
#include <linux/netlink.h>
#include <linux/rtnetlink.h>
#include <net/if.h>
#include <net/if_arp.h>
#include <sys/socket.h>
#include <sys/time.h>

#include <array>
#include <cerrno>
#include <cstddef>
#include <cstring>

#include "platform/files/unique_fd.hpp"

namespace crspf {
namespace {

using Bytes = std::span<const std::uint8_t>;

/// Copied, for attributes are aligned to four bytes only. False where there are too few.
template <typename Plain>
bool take(Bytes bytes, Plain& value) {
    if (bytes.size() < sizeof(value)) {
        return false;
    }
    std::memcpy(&value, bytes.data(), sizeof(value));
    return true;
}

/// Calls visit(type, content) for each attribute up to the first that is not whole.
template <typename Visit>
void for_each_attribute(Bytes bytes, const Visit& visit) {
    rtattr head{};
    while (take(bytes, head) && head.rta_len >= sizeof(head) && head.rta_len <= bytes.size()) {
        visit(head.rta_type & NLA_TYPE_MASK, bytes.subspan(sizeof(head), head.rta_len - sizeof(head)));
        const std::size_t next = (std::size_t{head.rta_len} + RTA_ALIGNTO - 1) / RTA_ALIGNTO * RTA_ALIGNTO;
        bytes = next < bytes.size() ? bytes.subspan(next) : Bytes{};
    }
}

void read_controller(Bytes data, CanLink& link) {
    for_each_attribute(data, [&](int type, Bytes content) {
        can_bittiming timing{};
        if (type == IFLA_CAN_BITTIMING && take(content, timing)) {
            link.bitrate_hz = timing.bitrate;
        } else if (type == IFLA_CAN_STATE) {
            link.controller = take(content, link.state);
        } else if (type == IFLA_CAN_RESTART_MS) {
            static_cast<void>(take(content, link.restart_ms));
        }
    });
}

}  // namespace

int parse_can_link(std::span<const std::uint8_t> answer, CanLink& link) {
    link = {};
    nlmsghdr head{};
    if (!take(answer, head) || head.nlmsg_len < sizeof(head) || head.nlmsg_len > answer.size()) {
        return EBADMSG;
    }
    const Bytes body = answer.subspan(sizeof(head), head.nlmsg_len - sizeof(head));
    nlmsgerr error{};
    if (head.nlmsg_type == NLMSG_ERROR && take(body, error) && error.error < 0) {
        return -error.error;
    }
    ifinfomsg info{};
    if (head.nlmsg_type != RTM_NEWLINK || !take(body, info)) {
        return EBADMSG;
    }
    link.is_can = info.ifi_type == ARPHRD_CAN;
    link.up = (info.ifi_flags & unsigned{IFF_UP}) != 0;
    for_each_attribute(body.subspan(sizeof(info)), [&](int type, Bytes content) {
        if (type == IFLA_LINKINFO) {
            for_each_attribute(content, [&](int inner, Bytes data) {
                if (inner == IFLA_INFO_DATA && link.is_can) {
                    read_controller(data, link);
                }
            });
        }
    });
    return 0;
}

int read_can_link(const std::string& interface, CanLink& link) {
    link = {};
    const unsigned index = ::if_nametoindex(interface.c_str());
    if (index == 0) {
        return ENODEV;
    }
    const UniqueFd fd(::socket(AF_NETLINK, SOCK_RAW | SOCK_CLOEXEC, NETLINK_ROUTE));
    const timeval patience{.tv_sec = 1, .tv_usec = 0};
    if (!fd.valid() || ::setsockopt(fd.get(), SOL_SOCKET, SO_RCVTIMEO, &patience, sizeof(patience)) != 0) {
        return errno;
    }
    struct {
        nlmsghdr head;
        ifinfomsg info;
    } request{};
    request.head.nlmsg_len = sizeof(request);
    request.head.nlmsg_type = RTM_GETLINK;
    request.head.nlmsg_flags = NLM_F_REQUEST;
    request.info.ifi_index = static_cast<int>(index);
    if (::send(fd.get(), &request, sizeof(request), 0) < 0) {
        return errno;
    }
    std::array<std::uint8_t, 32768> answer{};  // the kernel's own bound of a message (NLMSG_GOODSIZE) is 8192
    const ssize_t got = ::recv(fd.get(), answer.data(), answer.size(), 0);
    return got < 0 ? errno : parse_can_link(Bytes(answer).first(static_cast<std::size_t>(got)), link);
}

}  // namespace crspf
