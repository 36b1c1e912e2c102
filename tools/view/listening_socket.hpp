// A TCP socket that listens at an address of this machine.
#pragma once

#include <cstdint>
#include <string>

#include "platform/files/unique_fd.hpp"

namespace crspf::view {

struct ListeningSocket {
    UniqueFd fd;
    std::uint16_t port = 0;  ///< the one that it has got, where 0 was asked for
    bool loopback = false;   ///< only this machine can reach it
};

/// @param address numeric or a name; IPv4 or IPv6
/// @param port 0: any that is free
/// @throws InputError: the address is none of this machine's, the port is taken or needs rights
[[nodiscard]] ListeningSocket listen_at(const std::string& address, std::uint16_t port);

/// Ready to be read without waiting. Not valid: nobody there, or no more descriptors.
[[nodiscard]] UniqueFd accept_one(int listening_fd);

}  // namespace crspf::view
