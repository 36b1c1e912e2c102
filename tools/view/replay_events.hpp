// What there is to tell of a recording that is played, scan by scan.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>

#include "core/slam/localizer.hpp"
#include "tools/crspf/run_player.hpp"
#include "tools/view/changed_tiles.hpp"
#include "tools/view/run_events.hpp"

namespace crspf::view {

/// Of one run, from its beginning. Stamps are UTC where the recording's are, on the repaired time line; they never run
/// back.
class ReplayEvents {
 public:
    using Out = std::function<void(const RunEvent&)>;
    static constexpr Duration kTilesEvery{500'000'000};
    static constexpr Duration kStatusEvery{1'000'000'000};

    explicit ReplayEvents(const Config& config);

    /// A scan that `player` has just played.
    void on_scan(const RunPlayer& player, const ScanResult& result, const Out& out);
    /// The run is at its end: what of the map has not been told yet.
    void on_end(RunPlayer& player, const Out& out);

    /// Since the first scan, of the recording's time.
    [[nodiscard]] double position_s() const { return (newest_ - first_).seconds(); }

 private:
    [[nodiscard]] std::int64_t utc_ns(Stamp stamp) const { return utc_of_zero_ns_ + stamp.ns; }
    void begin(const RunPlayer& player, const ScanResult& result);
    [[nodiscard]] ScanEvent scan_event(const RunPlayer& player, const ScanResult& result) const;
    [[nodiscard]] StatusEvent status_event(const RunPlayer& player, const ScanResult& result) const;
    void tell_of_changes(const RunPlayer& player, const ScanResult& result, const Out& out);

    AnalyserParams thresholds_;
    ChangedTiles tiles_;
    bool begun_ = false;
    std::int64_t utc_of_zero_ns_ = 0;
    Stamp first_;
    Stamp newest_;
    std::optional<Stamp> tiles_told_;
    std::optional<Stamp> status_told_;
    ScanResult last_;
    std::uint64_t damaged_told_ = 0;
};

}  // namespace crspf::view
