// The end of a command that goes on until it is told to stop.
#pragma once

#include <atomic>

namespace crspf::cli {

/// From now on SIGINT (Ctrl-C) and SIGTERM set the flag that is returned, and do nothing else.
const std::atomic<bool>& stop_on_signals();

}  // namespace crspf::cli
