// Whatever a peer sends to the control socket: a request that is taken can be said again and means the same.
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <string>
#include <string_view>

#include "platform/crspfd/control_protocol.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    // NOLINTNEXTLINE(cppcoreguidelines-pro-type-reinterpret-cast): bytes as text
    const std::string_view line(reinterpret_cast<const char*>(data), size);
    std::string error;
    const auto request = crspf::parse_request(line, error);
    if (!request) {
        if (error.empty() || crspf::error_line(error).back() != '\n') {
            std::abort();
        }
        return 0;
    }
    const auto again = crspf::parse_request(crspf::request_line(*request), error);
    if (!again || again->command != request->command || again->text != request->text) {
        std::abort();
    }
    return 0;
}
