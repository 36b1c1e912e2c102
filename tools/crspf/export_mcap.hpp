// A run as an MCAP file with the channels that `crspf view` has.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>

#include "tools/crspf/run_player.hpp"
#include "tools/view/channel_schemas.hpp"
#include "tools/view/channels.hpp"
#include "tools/view/mcap_writer.hpp"
#include "tools/view/replay_events.hpp"

namespace crspf {

/// Every message, but /map and /path, which are wholes each time: every ten seconds of the recording, and at its end.
/// Each throws InputError for a file that cannot be written.
class McapExport {
 public:
    static constexpr std::int64_t kWholesEvery_ns = 10'000'000'000;

    McapExport(const std::filesystem::path& file, const Config& config);
    /// A scan that `player` has just played.
    void on_scan(const RunPlayer& player, const ScanResult& result);
    /// The last call.
    void finish(RunPlayer& player);

 private:
    void take(const view::RunEvent& event);
    void write_what_is_new(bool wholes);

    view::Channels channels_;
    view::McapWriter writer_;
    view::ReplayEvents events_;
    std::array<std::uint64_t, view::kTopics> cursors_{};
    std::optional<std::int64_t> wholes_ns_;  ///< when they were written last
};

}  // namespace crspf
