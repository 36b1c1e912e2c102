#include "tools/mqtt/broker_address.hpp"

#include <charconv>
#include <system_error>

#include "platform/files/input_error.hpp"

namespace crspf::mqtt {
namespace {

constexpr std::uint16_t kPort = 1883;
constexpr std::uint16_t kTlsPort = 8883;

[[noreturn]] void refuse(std::string_view text) {
    throw InputError("--broker " + std::string(text) +
                     ": is no HOST[:PORT]; as broker.example:1883, or [fd00::1]:8883");
}

}  // namespace

BrokerAddress parse_broker(std::string_view text, bool tls) {
    BrokerAddress address{.host = {}, .port = tls ? kTlsPort : kPort};
    std::string_view rest = text;
    std::string_view host;
    if (!rest.empty() && rest.front() == '[') {
        const std::size_t end = rest.find(']');
        if (end == std::string_view::npos) {
            refuse(text);
        }
        host = rest.substr(1, end - 1);
        rest.remove_prefix(end + 1);
    } else {
        host = rest.substr(0, rest.find(':'));
        rest.remove_prefix(host.size());
    }
    if (host.empty() || host.find_first_of(" /@") != std::string_view::npos) {
        refuse(text);
    }
    address.host = host;
    if (!rest.empty()) {
        const auto [end, error] = std::from_chars(rest.data() + 1, rest.data() + rest.size(), address.port);
        if (rest.front() != ':' || error != std::errc() || end != rest.data() + rest.size() || address.port == 0) {
            refuse(text);
        }
    }
    return address;
}

std::string text_of(const BrokerAddress& address) {
    const bool v6 = address.host.find(':') != std::string::npos;
    return (v6 ? "[" + address.host + "]" : address.host) + ":" + std::to_string(address.port);
}

}  // namespace crspf::mqtt
