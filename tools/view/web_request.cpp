#include "tools/view/web_request.hpp"

#include <array>
#include <string>
#include <string_view>

namespace crspf::view {
namespace {

std::string header(lws* wsi, lws_token_indexes token) {
    const int length = lws_hdr_total_length(wsi, token);
    if (length <= 0) {
        return {};
    }
    std::string text(static_cast<std::size_t>(length) + 1, '\0');  // and its terminating 0
    const int copied = lws_hdr_copy(wsi, text.data(), length + 1, token);
    text.resize(copied > 0 ? static_cast<std::size_t>(copied) : 0);
    return text;
}

}  // namespace

Request request_of(lws* wsi) {
    constexpr std::string_view kBearer = "Bearer ";
    Request request;
    request.host = header(wsi, WSI_TOKEN_HOST);
    request.origin = header(wsi, WSI_TOKEN_ORIGIN);
    const std::string authorization = header(wsi, WSI_TOKEN_HTTP_AUTHORIZATION);
    if (authorization.compare(0, kBearer.size(), kBearer) == 0) {
        request.token = authorization.substr(kBearer.size());
        return request;
    }
    std::array<char, 256> value{};
    if (const char* token = lws_get_urlarg_by_name(wsi, "token=", value.data(), value.size())) {
        request.token = token;
    }
    return request;
}

const char* reason_of(Access access) {
    switch (access) {
        case Access::kWrongHost:
            return "This server is called 127.0.0.1 or localhost; start crspf view with --listen ADDRESS to be reached "
                   "by another name.\n";
        case Access::kWrongOrigin:
            return "This page may not ask; start crspf view with --allow-origin and its origin.\n";
        case Access::kWrongToken: return "A token is wanted: ?token= in the URL, or Authorization: Bearer.\n";
        default: return "";
    }
}

unsigned status_of(Access access) {
    return access == Access::kWrongToken ? HTTP_STATUS_UNAUTHORIZED : HTTP_STATUS_FORBIDDEN;
}

}  // namespace crspf::view
