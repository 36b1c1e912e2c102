#include "tools/view/access.hpp"

#include <nettle/memops.h>
#include <sys/random.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <system_error>

#include "platform/files/input_error.hpp"
#include "platform/files/secret_file.hpp"

namespace crspf::view {
namespace {

/// "localhost:8765" to "localhost", "[::1]:8765" to "[::1]".
std::string_view without_port(std::string_view host) {
    const std::size_t from = host.find(']') == std::string_view::npos ? 0 : host.find(']');
    return host.substr(0, host.find(':', from));
}

bool names_loopback(std::string_view host) {
    const std::string_view name = without_port(host);
    const bool address = name.substr(0, 4) == "127." && name.find_first_not_of("0123456789.") == std::string_view::npos;
    return address || name == "localhost" || name == "[::1]";
}

bool same_secret(const std::string& one, const std::string& other) {
    return one.size() == other.size() && ::nettle_memeql_sec(one.data(), other.data(), one.size()) != 0;
}

bool trusted_origin(const AccessRules& rules, const Request& request) {
    const auto& allowed = rules.allowed_origins;
    return request.origin.empty() || request.origin == "http://" + request.host ||
           std::find(allowed.begin(), allowed.end(), request.origin) != allowed.end();
}

}  // namespace

Access may_see_page(const AccessRules& rules, const Request& request) {
    return rules.loopback && !names_loopback(request.host) ? Access::kWrongHost : Access::kGranted;
}

Access may_see_data(const AccessRules& rules, const Request& request) {
    if (rules.loopback && !names_loopback(request.host)) {
        return Access::kWrongHost;
    }
    if (rules.loopback && !trusted_origin(rules, request)) {
        return Access::kWrongOrigin;
    }
    if (!rules.token.empty() && !same_secret(rules.token, request.token)) {
        return Access::kWrongToken;
    }
    return Access::kGranted;
}

std::string make_token() {
    constexpr std::string_view kDigits = "0123456789abcdef";
    std::array<std::uint8_t, 16> random{};
    if (::getentropy(random.data(), random.size()) != 0) {
        throw std::system_error(errno, std::generic_category(), "getentropy");
    }
    std::string token;
    for (const std::uint8_t byte : random) {
        token += kDigits[byte >> 4U];
        token += kDigits[byte & 0xFU];
    }
    return token;
}

std::string token_of_file(const std::string& file) {
    constexpr std::size_t kShortest = 16;
    std::string token = read_secret(file);
    token.erase(token.find_last_not_of(" \t\r\n") + 1);
    const bool for_url = token.find_first_not_of(
                             "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789-._~") == std::string::npos;
    if (token.size() < kShortest || !for_url) {
        throw InputError(file +
                         ": not a token: at least 16 of A-Z a-z 0-9 - . _ ~ in one line; make one by: (umask 077; "
                         "openssl rand -hex 16 > " +
                         file + ")");
    }
    return token;
}

}  // namespace crspf::view
