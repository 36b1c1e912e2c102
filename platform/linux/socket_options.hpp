// Small things that all sockets need.
#pragma once

#include <netinet/in.h>
#include <sys/socket.h>

#include <cstdint>

#include "platform/linux/is_temporary.hpp"

namespace crspf {

inline bool set_option(int fd, int level, int name, int value) {
    return ::setsockopt(fd, level, name, &value, sizeof(value)) == 0;
}

/// The error that waits on the socket, which is then gone; 0: none.
inline int pending_error(int fd) {
    int error = 0;
    socklen_t size = sizeof(error);
    return ::getsockopt(fd, SOL_SOCKET, SO_ERROR, &error, &size) == 0 ? error : errno;
}

/// An address of any family as the system calls take it.
template <typename Address>
const sockaddr* any_address(const Address& address) {
    // NOLINTNEXTLINE(cppcoreguidelines-pro-type-reinterpret-cast): POSIX's way to pass addresses
    return reinterpret_cast<const sockaddr*>(&address);
}

inline sockaddr_in socket_address(std::uint32_t address, std::uint16_t port) {
    sockaddr_in made{};
    made.sin_family = AF_INET;
    made.sin_addr.s_addr = htonl(address);
    made.sin_port = htons(port);
    return made;
}

}  // namespace crspf
