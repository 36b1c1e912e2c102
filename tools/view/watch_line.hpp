// What crspfd says to those who watch it, line by line (docs/service.md, Control; platform/crspfd/watch_board.hpp says
// it).
#pragma once

#include <cstddef>
#include <string>
#include <string_view>

#include "tools/view/run_events.hpp"

namespace crspf::view {

/// Of a line, its end included. A tenth of that is the longest that crspfd makes.
inline constexpr std::size_t kWatchLineMax = std::size_t{1} << 20U;

struct WatchLine {
    enum class Kind : std::uint8_t {
        kWelcome,  ///< the request to watch is granted
        kRefusal,  ///< it is not: `text` says why
        kEvent,
        kBad,  ///< it is none of crspfd's: `text` says why
    };
    Kind kind = Kind::kBad;
    RunEvent event;  ///< ScanEvent, TilesEvent, StatusEvent or LogLine
    std::string text;
};

/// Whatever the bytes: no exception. All numbers of an event are finite, its tiles lie inside the map's extent.
/// @param line without its end
[[nodiscard]] WatchLine parse_watch_line(std::string_view line);

}  // namespace crspf::view
