// The address of a Unix socket.
#pragma once

#include <sys/socket.h>
#include <sys/un.h>

#include <filesystem>
#include <string>

#include "platform/files/input_error.hpp"

namespace crspf {

class ControlAddress {
 public:
    /// Throws InputError for a path that is longer than such an address can be.
    explicit ControlAddress(const std::filesystem::path& path) {
        const std::string text = path.string();
        if (text.empty() || text.size() >= sizeof address_.sun_path) {
            throw InputError(text + ": the path of a socket has 1 to " + std::to_string(sizeof address_.sun_path - 1) +
                             " characters; choose a shorter one");
        }
        address_.sun_family = AF_UNIX;
        text.copy(address_.sun_path, text.size());
    }

    [[nodiscard]] const sockaddr* get() const {
        // NOLINTNEXTLINE(cppcoreguidelines-pro-type-reinterpret-cast): the socket interface is made so
        return reinterpret_cast<const sockaddr*>(&address_);
    }
    [[nodiscard]] static socklen_t size() { return sizeof(sockaddr_un); }

 private:
    sockaddr_un address_{};
};

}  // namespace crspf
