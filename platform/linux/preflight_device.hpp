// The part of the preflight that looks at one sensor's port.
#pragma once

#include "platform/linux/preflight.hpp"

namespace crspf {

[[nodiscard]] PreflightCheck check_device(const PreflightDevice& device, const Machine& machine);

}  // namespace crspf
