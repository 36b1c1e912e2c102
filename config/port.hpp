// Addresses as text.
#pragma once

#include <cstdint>
#include <optional>
#include <string_view>

#include "config/sources.hpp"

namespace crspf {

/// 192.168.1.201 is 0xC0A801C9.
[[nodiscard]] std::optional<std::uint32_t> parse_ipv4(std::string_view text);

/// "/dev/...", "tcp://ADDRESS:PORT", "udp://[ADDRESS]:PORT", or else the name of a CAN interface.
[[nodiscard]] std::optional<PortConfig> parse_port(std::string_view text);

}  // namespace crspf
