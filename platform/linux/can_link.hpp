// A CAN interface as the kernel describes it: what `ip -details link show can0` prints.
// Source: linux/if_link.h, linux/can/netlink.h. Ordinary code, for the start; not for real-time threads.
#pragma once

#include <cstdint>
#include <span>
#include <string>

namespace crspf {

struct CanLink {
    bool is_can = false;      ///< another kind of interface may bear the name
    bool up = false;          ///< by the administrator
    bool controller = false;  ///< with bit timing; false: virtual, or a serial line's
    std::uint32_t bitrate_hz = 0;
    std::uint32_t restart_ms = 0;  ///< from bus-off back to the bus; 0: never by itself
    std::uint32_t state = 0;       ///< enum can_state of linux/can/netlink.h
};

/// The kernel's answer to RTM_GETLINK. Returns 0, or errno: the kernel's, or EBADMSG for what is no such answer.
[[nodiscard]] int parse_can_link(std::span<const std::uint8_t> answer, CanLink& link);

/// Asks the kernel, which answers at once; waits a second at most. Returns 0, or errno; ENODEV: no such interface.
[[nodiscard]] int read_can_link(const std::string& interface, CanLink& link);

}  // namespace crspf
