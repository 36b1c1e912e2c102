// Errors after which the same call may succeed.
#pragma once

#include <cerrno>

namespace crspf {

[[nodiscard]] constexpr bool is_temporary(int error) {
    return error == EAGAIN || error == EINTR;
}

}  // namespace crspf
