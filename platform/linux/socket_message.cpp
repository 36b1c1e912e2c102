#include "platform/linux/socket_message.hpp"

#include <sys/socket.h>
#include <sys/uio.h>

#include <array>
#include <cerrno>
#include <cstring>
#include <ctime>

#include "platform/linux/monotonic_clock.hpp"
#include "platform/linux/socket_options.hpp"

namespace crspf {

Stamp to_monotonic(Stamp real, Stamp now_real, Stamp now_monotonic) {
    const Duration age = now_real - real;
    constexpr Duration kAgeMax{1'000'000'000};
    return age < Duration{} || age > kAgeMax ? now_monotonic : now_monotonic - age;
}

bool MessageReceiver::prepare(int fd) {
    return set_option(fd, SOL_SOCKET, SO_TIMESTAMPNS, 1) && set_option(fd, SOL_SOCKET, SO_RXQ_OVFL, 1);
}

SocketMessage MessageReceiver::receive(int fd, std::span<std::uint8_t> into) {
    SocketMessage message;
    alignas(cmsghdr) std::array<std::uint8_t, 256> control{};
    iovec part{.iov_base = into.data(), .iov_len = into.size()};
    msghdr header{};
    header.msg_name = &message.from;
    header.msg_namelen = sizeof(message.from);
    header.msg_iov = &part;
    header.msg_iovlen = 1;
    header.msg_control = control.data();
    header.msg_controllen = control.size();
    const ssize_t got = ::recvmsg(fd, &header, MSG_DONTWAIT);
    if (got < 0) {
        message.error = errno;
        return message;
    }
    message.bytes = static_cast<std::size_t>(got);
    message.truncated = (header.msg_flags & MSG_TRUNC) != 0;
    message.stamp = monotonic_now();
    for (cmsghdr* note = CMSG_FIRSTHDR(&header); note != nullptr; note = CMSG_NXTHDR(&header, note)) {
        if (note->cmsg_level != SOL_SOCKET) {
            continue;
        }
        if (note->cmsg_type == SCM_TIMESTAMPNS) {
            timespec real{};
            std::memcpy(&real, CMSG_DATA(note), sizeof(real));
            message.stamp = to_monotonic({std::int64_t{real.tv_sec} * 1'000'000'000 + real.tv_nsec},
                                         clock_now(CLOCK_REALTIME), message.stamp);
        } else if (note->cmsg_type == SO_RXQ_OVFL) {
            std::uint32_t dropped = 0;
            std::memcpy(&dropped, CMSG_DATA(note), sizeof(dropped));
            message.dropped = dropped - dropped_;  // wraps as the kernel's counter does
            dropped_ = dropped;
        }
    }
    return message;
}

}  // namespace crspf
