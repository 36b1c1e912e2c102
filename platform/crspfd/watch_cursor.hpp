// How far somebody who watches the service has come: all that is kept of him, however slow he is.
#pragma once

#include <cstdint>

namespace crspf {

/// Numbers of what he had last, each counted by WatchBoard; 0: nothing yet.
struct WatchCursor {
    std::uint64_t scan = 0;
    std::uint64_t status = 0;
    std::uint64_t log = 0;
    std::uint64_t change = 0;  ///< of the map
    std::uint8_t turn = 0;     ///< which of the four comes next, so that none waits for another for ever
};

}  // namespace crspf
