// What a configuration needs of the machine, for run_preflight().
#pragma once

#include "config/config.hpp"
#include "platform/linux/preflight.hpp"

namespace crspf {

/// Memory of the core's one object and room for the rest, the state directory, and each source's port.
[[nodiscard]] PreflightNeeds needs_of(const Config& config);

}  // namespace crspf
