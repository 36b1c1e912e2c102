// The table of channels (DESIGN.md): topics, and JSON schemas of what is on them.
#pragma once

#include <cstddef>
#include <vector>

#include "tools/view/channels.hpp"

namespace crspf::view {

/// Places in the table.
enum class Topic : std::size_t {
    kTf,
    kPose,
    kPath,
    kScan,
    kMap,
    kMapTiles,
    kMatch,
    kStatus,
    kDiagnostics,
    kLog,
};
inline constexpr std::size_t kTopics = 10;

/// In the order of Topic. Those of foxglove.* are by the facts of Foxglove's published schemas, version 2.1.0, without
/// what we never send.
[[nodiscard]] std::vector<ChannelInfo> channel_table();

}  // namespace crspf::view
