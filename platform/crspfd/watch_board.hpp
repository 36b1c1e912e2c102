// What those who watch the service are sent: a line of JSON for each event (docs/service.md, Control).
#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>

#include "core/base/time.hpp"
#include "core/slam/occupancy.hpp"
#include "core/slam/slam_params.hpp"
#include "platform/crspfd/exchange.hpp"
#include "platform/crspfd/watch_cursor.hpp"
#include "platform/service/shown_map.hpp"

namespace crspf {

/// The newest of everything, for any number of watchers: each is a cursor, and a line is made when he can take it. What
/// he was too slow for is gone, and nobody waits for him. The control thread's.
class WatchBoard {
 public:
    static constexpr std::size_t kTilesALine = 16;
    static constexpr std::size_t kLogLines = 200;
    static constexpr std::size_t kLogTextMax = 1000;  ///< [bytes] of a line; the rest is cut off
    enum class Level : std::uint8_t { kDebug, kInfo, kWarning, kError };

    /// Whether somebody watches. Where nobody does only the log is kept.
    void watched(bool by_somebody);
    [[nodiscard]] bool watched() const { return watched_; }

    // What is new. Stamps: [ns] UTC since 1970.

    void take_scan(const WatchedScan& scan, Duration utc_minus_stamp, const AnalyserParams& thresholds);
    void take_status(std::int64_t stamp_ns, const nlohmann::ordered_json& status);
    void take_log(std::int64_t stamp_ns, Level level, std::string_view text);
    /// Another map: what was known of tiles is forgotten.
    void begin_map(double resolution_m);
    /// As ShownMap takes one.
    void take_tile(Cell corner, const TileCells& cells);

    /// The next line, its end included; empty: he has had all there is. Beside the line: constant time, logarithmic in
    /// the tiles.
    [[nodiscard]] std::string next(WatchCursor& cursor);

 private:
    struct LogEntry {
        std::int64_t stamp_ns = 0;
        Level level = Level::kInfo;
        std::string text;
    };
    struct Scan {
        WatchedScan scan;
        std::int64_t stamp_ns = 0;
        AnalyserParams thresholds;
    };

    std::string next_status(WatchCursor& cursor);
    std::string next_scan(WatchCursor& cursor);
    std::string next_tiles(WatchCursor& cursor);
    std::string next_log(WatchCursor& cursor);

    bool watched_ = false;

    std::unique_ptr<Scan> scan_;
    std::uint64_t scans_ = 0;
    std::string scan_line_;  ///< of it, once somebody wanted it

    std::uint64_t statuses_ = 0;
    std::string status_line_;

    std::deque<LogEntry> log_;
    std::uint64_t logged_ = 0;  ///< lines in all

    double resolution_m_ = 0.0;
    bool map_begun_ = false;
    ShownMap map_;
};

}  // namespace crspf
