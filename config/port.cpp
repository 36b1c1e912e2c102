#include "config/port.hpp"

#include <algorithm>
#include <charconv>

namespace crspf {

namespace {

/// The whole of `text` as a number of at most `most`.
std::optional<std::uint32_t> number(std::string_view text, std::uint32_t most) {
    std::uint32_t value = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (error != std::errc{} || end != text.data() + text.size() || value > most) {
        return std::nullopt;
    }
    return value;
}

std::optional<PortConfig> parse_socket(std::string_view text, PortConfig::Kind kind) {
    const std::size_t colon = text.rfind(':');
    if (colon == text.npos) {
        return std::nullopt;
    }
    const std::string_view host = text.substr(0, colon);
    const std::optional<std::uint32_t> port = number(text.substr(colon + 1), 65535);
    const bool any = kind == PortConfig::Kind::kUdp && host.empty();
    const std::optional<std::uint32_t> address = any ? std::optional<std::uint32_t>(0) : parse_ipv4(host);
    if (!port || *port == 0 || !address) {
        return std::nullopt;
    }
    return PortConfig{.kind = kind, .device = {}, .address = *address, .port = static_cast<std::uint16_t>(*port)};
}

}  // namespace

std::optional<std::uint32_t> parse_ipv4(std::string_view text) {
    std::uint32_t address = 0;
    for (int i = 0; i < 4; ++i) {
        const std::size_t dot = i < 3 ? text.find('.') : text.size();
        if (dot > 3) {  // or none
            return std::nullopt;
        }
        const std::optional<std::uint32_t> part = number(text.substr(0, dot), 255);
        if (!part) {
            return std::nullopt;
        }
        address = (address << 8U) | *part;
        text.remove_prefix(std::min(dot + 1, text.size()));
    }
    return address;
}

std::optional<PortConfig> parse_port(std::string_view text) {
    constexpr std::string_view kTcp = "tcp://";
    constexpr std::string_view kUdp = "udp://";
    constexpr std::size_t kInterfaceMax = 15;  // IFNAMSIZ - 1
    if (text.starts_with(kTcp)) {
        return parse_socket(text.substr(kTcp.size()), PortConfig::Kind::kTcp);
    }
    if (text.starts_with(kUdp)) {
        return parse_socket(text.substr(kUdp.size()), PortConfig::Kind::kUdp);
    }
    if (text.starts_with('/')) {
        return PortConfig{.kind = PortConfig::Kind::kSerial, .device = std::string(text)};
    }
    const bool interface = !text.empty() && text.size() <= kInterfaceMax && text.find_first_of("/: \t\n") == text.npos;
    return interface ? std::optional(PortConfig{.kind = PortConfig::Kind::kCan, .device = std::string(text)})
                     : std::nullopt;
}

}  // namespace crspf
