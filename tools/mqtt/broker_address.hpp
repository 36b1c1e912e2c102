// Where a broker is, as a command line says it.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

namespace crspf::mqtt {

struct BrokerAddress {
    std::string host;
    std::uint16_t port = 0;

    friend bool operator==(const BrokerAddress&, const BrokerAddress&) = default;
};

/// HOST, HOST:PORT, [IPV6] or [IPV6]:PORT. Without a port 1883, with TLS 8883. Throws InputError for all else.
[[nodiscard]] BrokerAddress parse_broker(std::string_view text, bool tls);

/// As parse_broker() reads it.
[[nodiscard]] std::string text_of(const BrokerAddress& address);

}  // namespace crspf::mqtt
