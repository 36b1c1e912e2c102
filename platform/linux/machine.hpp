// What the preflight checks ask of the machine, in one place, so that a test can plant a broken one.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>

#include "platform/linux/can_link.hpp"

namespace crspf {

/// Facts that are files lie under `root`; what no file tells is a function. None changes the machine, none waits for
/// more than a second. An `int` result is errno, 0 for success.
struct Machine {
    std::filesystem::path root = "/";  ///< of proc, sys, dev, run and var
    /// Of SCHED_FIFO at this priority, in a thread that does nothing else.
    std::function<int(int priority)> try_fifo;
    std::function<std::int64_t()> timer_resolution_ns;
    /// Whether something keeps the calendar clock right; empty: this process may not ask.
    std::function<std::optional<bool>()> clock_synchronised;
    /// Of reading and writing it, as this process. Does not open it: that would move a serial line's DTR.
    std::function<int(const std::filesystem::path& file)> access;
    /// Empty: not to be found out.
    std::function<std::optional<std::uint64_t>(const std::filesystem::path& directory)> free_bytes;
    /// Of receiving datagrams there. @param address own IPv4, 0 for any
    std::function<int(std::uint32_t address, std::uint16_t port)> try_udp;
    /// Of finding a way to this IPv4 address. Sends nothing.
    std::function<int(std::uint32_t address)> route_to;
    std::function<int(const std::string& interface, CanLink& link)> can_link;
};

/// The one that this process runs on.
[[nodiscard]] Machine this_machine();

}  // namespace crspf
