// Run events as messages on channels: for each reader what it has not had, bounded however slow it is (DESIGN.md).
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "tools/view/run_events.hpp"

namespace crspf::view {

/// Of a channel what both Foxglove's protocol and MCAP say of one. Encoding: json; schema's: jsonschema.
struct ChannelInfo {
    std::string topic;
    std::string schema_name;
    std::string schema;  ///< JSON schema
};

struct Message {
    std::int64_t stamp_ns = 0;  ///< [ns] UTC since 1970
    std::string data;           ///< JSON
};

/// Not thread-safe: one owner. Messages are shared and never change.
class Channels {
 public:
    using Id = std::size_t;  ///< place in all()
    Channels();
    Channels(const Channels&) = delete;
    Channels& operator=(const Channels&) = delete;
    ~Channels();

    [[nodiscard]] const std::vector<ChannelInfo>& all() const;
    /// What happened, onto all channels that it concerns.
    void take(const RunEvent& event);

    /// What a reader that has subscribed is to get next on a channel, if there is anything it has not had. A cursor
    /// begins at 0 and is this channel's only. Constant time but for /map, whose picture is made when it is first asked
    /// for, and /map/tiles: linear in the tiles changed.
    [[nodiscard]] std::shared_ptr<const Message> next(Id channel, std::uint64_t& cursor);

 private:
    struct State;
    std::unique_ptr<State> state_;
};

}  // namespace crspf::view
