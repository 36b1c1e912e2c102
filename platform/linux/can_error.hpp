// What a controller's error frame says about the bus (linux/can/error.h).
#pragma once

#include "platform/ports/can_bus.hpp"

namespace crspf {

/// Of a frame with `error` set; others change nothing.
void note_can_error(const CanFrame& frame, CanHealth& health);

}  // namespace crspf
