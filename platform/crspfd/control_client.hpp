// The operator's end of the control socket.
#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>

#include "core/base/time.hpp"
#include "platform/crspfd/control_protocol.hpp"

namespace crspf {

/// Asks and waits for the answer, at most `wait`. Throws InputError: nobody listens, no permission, no answer, or the
/// service's own error.
[[nodiscard]] nlohmann::ordered_json ask(const std::filesystem::path& socket, const ControlRequest& request,
                                         Duration wait);

}  // namespace crspf
