#include "tools/view/listening_socket.hpp"

#include <arpa/inet.h>
#include <netdb.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <sys/socket.h>

#include <cerrno>
#include <memory>
#include <system_error>

#include "platform/files/input_error.hpp"

namespace crspf::view {
namespace {

using AddressList = std::unique_ptr<addrinfo, decltype(&::freeaddrinfo)>;

AddressList addresses_of(const std::string& address, const std::string& port) {
    addrinfo hints{};
    hints.ai_socktype = SOCK_STREAM;
    hints.ai_flags = AI_PASSIVE | AI_NUMERICSERV;
    addrinfo* found = nullptr;
    if (const int error = ::getaddrinfo(address.c_str(), port.c_str(), &hints, &found); error != 0) {
        throw InputError("--listen " + address + ": " + ::gai_strerror(error) +
                         "; give an address of this machine, as `ip address` shows it, or 0.0.0.0 for all");
    }
    return {found, &::freeaddrinfo};
}

[[noreturn]] void fail(const std::string& where, int error) {
    const std::string what = where + ": " + std::generic_category().message(error);
    switch (error) {
        case EADDRINUSE: throw InputError(what + "; another crspf view? Stop it, or take another --port");
        case EACCES: throw InputError(what + "; ports below 1024 are the administrator's: take another --port");
        case EADDRNOTAVAIL: throw InputError(what + "; give --listen an address that `ip address` shows");
        default: throw InputError(what + "; take another --listen or --port");
    }
}

/// Of what the kernel says of a bound socket.
void describe(ListeningSocket& socket) {
    sockaddr_storage bound{};
    socklen_t size = sizeof bound;
    // NOLINTBEGIN(cppcoreguidelines-pro-type-reinterpret-cast): the sockets' own way
    if (::getsockname(socket.fd.get(), reinterpret_cast<sockaddr*>(&bound), &size) != 0) {
        throw std::system_error(errno, std::generic_category(), "getsockname");
    }
    if (bound.ss_family == AF_INET6) {
        const auto& in6 = reinterpret_cast<const sockaddr_in6&>(bound);
        socket.port = ntohs(in6.sin6_port);
        socket.loopback = IN6_IS_ADDR_LOOPBACK(&in6.sin6_addr);
    } else {
        const auto& in = reinterpret_cast<const sockaddr_in&>(bound);
        socket.port = ntohs(in.sin_port);
        socket.loopback = (ntohl(in.sin_addr.s_addr) >> 24U) == 127U;
    }
    // NOLINTEND(cppcoreguidelines-pro-type-reinterpret-cast)
}

}  // namespace

ListeningSocket listen_at(const std::string& address, std::uint16_t port) {
    constexpr int kBacklog = 16;
    const AddressList addresses = addresses_of(address, std::to_string(port));
    const std::string where = address + ", port " + std::to_string(port);
    ListeningSocket socket;
    socket.fd = UniqueFd(::socket(addresses->ai_family, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0));
    const int on = 1;  // a server that was here before leaves connections behind, which hold the port for a minute
    if (!socket.fd.valid() || ::setsockopt(socket.fd.get(), SOL_SOCKET, SO_REUSEADDR, &on, sizeof on) != 0 ||
        ::bind(socket.fd.get(), addresses->ai_addr, addresses->ai_addrlen) != 0 ||
        ::listen(socket.fd.get(), kBacklog) != 0) {
        fail(where, errno);
    }
    describe(socket);
    return socket;
}

UniqueFd accept_one(int listening_fd) {
    UniqueFd fd(::accept4(listening_fd, nullptr, nullptr, SOCK_CLOEXEC | SOCK_NONBLOCK));
    if (fd.valid()) {
        // What the kernel holds of a slow peer's is old by the time it arrives: let it hold little.
        const int unsent_max = 128 * 1024;  // [bytes]
        const int on = 1;
        ::setsockopt(fd.get(), IPPROTO_TCP, TCP_NOTSENT_LOWAT, &unsent_max, sizeof unsent_max);
        ::setsockopt(fd.get(), IPPROTO_TCP, TCP_NODELAY, &on, sizeof on);
    }
    return fd;
}

}  // namespace crspf::view
