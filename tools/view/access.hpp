// Who may have what the view's server knows: by the name it was called by, the page that asks, and the token.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace crspf::view {

struct AccessRules {
    /// Only this machine can connect, which a page of the internet does, too, where its own name leads to 127.0.0.1:
    /// the name that it was called by has to be this machine's, and the page one that is trusted.
    bool loopback = true;
    std::string token;                         ///< empty: none is demanded
    std::vector<std::string> allowed_origins;  ///< "https://app.foxglove.dev"; beside the page itself
};

/// What a request says of itself.
struct Request {
    std::string host;    ///< "localhost:8765"
    std::string origin;  ///< "http://localhost:8765"; empty: not from a page
    std::string token;
};

enum class Access { kGranted, kWrongHost, kWrongOrigin, kWrongToken };

/// Whether the page's files may be had, which are no secret.
[[nodiscard]] Access may_see_page(const AccessRules& rules, const Request& request);
/// Whether the robot's data may be had.
[[nodiscard]] Access may_see_data(const AccessRules& rules, const Request& request);

/// 128 bits of the kernel's, in hexadecimal.
[[nodiscard]] std::string make_token();
/// @throws InputError: not readable, readable to everybody, or not a token (16 characters or more of a URL's)
[[nodiscard]] std::string token_of_file(const std::string& file);

}  // namespace crspf::view
