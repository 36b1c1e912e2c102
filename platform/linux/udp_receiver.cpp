#include "platform/linux/udp_receiver.hpp"

#include <arpa/inet.h>
#include <poll.h>
#include <sys/socket.h>

#include <cerrno>
#include <utility>

#include "platform/linux/socket_options.hpp"

namespace crspf {

bool UdpReceiver::open(Duration wait) {
    if (fd_.is_open()) {
        return true;
    }
    if (!fd_.may_open(wait)) {
        return false;
    }
    // No SO_REUSEADDR: of two listeners only one would get each datagram, and neither would know.
    UniqueFd fd(::socket(AF_INET, SOCK_DGRAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0));
    const sockaddr_in own = socket_address(params_.own_address, params_.port);
    if (!fd.valid() || !MessageReceiver::prepare(fd.get()) ||
        !set_option(fd.get(), SOL_SOCKET, SO_RCVBUF, params_.buffer_bytes) ||
        ::bind(fd.get(), any_address(own), sizeof(own)) != 0) {
        fd_.failed(errno);
        return false;
    }
    messages_.restart();
    fd_.opened(std::move(fd));
    return true;
}

Datagram UdpReceiver::receive(std::span<std::uint8_t> into, Duration wait) {
    const Stamp deadline = monotonic_now() + wait;
    if (!open(wait)) {
        return {.io = {.status = IoStatus::kClosed}};
    }
    // Others' datagrams must not keep the caller beyond its wait: the clock is looked at after each of them.
    for (Stamp now = monotonic_now();; now = monotonic_now()) {
        const short events = wait_for(fd_.get(), POLLIN, deadline - now);
        if (events == 0) {
            return {};
        }
        const SocketMessage message = messages_.receive(fd_.get(), into);
        if (message.error != 0 && (!is_temporary(message.error) || (events & POLLIN) == 0)) {
            fd_.lost(message.error);
            return {.io = {.status = IoStatus::kClosed}};
        }
        dropped_ += message.dropped;
        counters_.dropped += message.dropped;
        const std::uint32_t source = ntohl(message.from.sin_addr.s_addr);
        if (message.error == 0 && (params_.source_address == 0 || source == params_.source_address)) {
            ++counters_.received;
            counters_.truncated += message.truncated ? 1 : 0;
            return {.io = {.status = IoStatus::kOk,
                           .bytes = message.bytes,
                           .stamp = message.stamp,
                           .dropped = std::exchange(dropped_, 0),
                           .truncated = message.truncated},
                    .source_address = source,
                    .source_port = ntohs(message.from.sin_port)};
        }
        counters_.refused += message.error == 0 ? 1 : 0;
        if (monotonic_now() >= deadline) {
            return {};
        }
    }
}

}  // namespace crspf
