// What is on the channels, message by message: JSON as channel_schemas.hpp describes it.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "core/base/pose.hpp"
#include "tools/view/channels.hpp"
#include "tools/view/run_events.hpp"

namespace crspf::view {

using Json = nlohmann::ordered_json;

/// The text of a message. Bytes that are no UTF-8, as a file's name may have, become U+FFFD.
[[nodiscard]] std::shared_ptr<const Message> message_of(std::int64_t stamp_ns, const Json& data);

/// {sec, nsec}; before 1970: 1970.
[[nodiscard]] Json time_of(std::int64_t stamp_ns);
/// foxglove.Pose.
[[nodiscard]] Json pose_of(const Pose2& pose);

[[nodiscard]] Json tf_message(const ScanEvent& scan);
[[nodiscard]] Json pose_message(const ScanEvent& scan);
[[nodiscard]] Json scan_message(const ScanEvent& scan);
[[nodiscard]] Json match_message(const ScanEvent& scan);
[[nodiscard]] Json path_message(std::int64_t stamp_ns, const std::vector<Pose2>& path);
[[nodiscard]] Json status_message(const StatusEvent& status);
[[nodiscard]] Json log_message(const LogLine& line);

/// A rectangle of TileImage's cells, row by row from the lowest y.
struct GridPicture {
    Pose2 P_map_corner;  ///< lower-left corner of cell (0, 0)
    double cell_m = 0.0;
    std::uint32_t columns = 0;
    std::vector<std::uint8_t> cells;
};
[[nodiscard]] Json map_message(std::int64_t stamp_ns, const GridPicture& picture);

}  // namespace crspf::view
