// What is said on the topics, as JSON (docs/mqtt.md). Units stand in the names, as in the service's status document.
#pragma once

#include <cstdint>
#include <nlohmann/json.hpp>
#include <string>

#include "platform/service/shown_map.hpp"
#include "tools/view/run_events.hpp"

namespace crspf::mqtt {

using Json = nlohmann::ordered_json;

/// Of a scan that the filter has seen.
[[nodiscard]] Json pose_of_scan(const view::ScanEvent& scan);
/// Of a status: the pose of that moment, by odometry alone where no scan comes. Null where the document has none.
[[nodiscard]] Json pose_of_status(const view::StatusEvent& status);

[[nodiscard]] Json log_payload(const view::LogLine& line);

/// @param map_id another for each map
[[nodiscard]] Json map_payload(std::int64_t map_id, double resolution_m);
[[nodiscard]] Json tile_payload(std::int64_t map_id, double resolution_m, const TileImage& image);

/// As it goes out. Bytes that are no UTF-8, as a file's name may have, become U+FFFD.
[[nodiscard]] std::string text_of(const Json& payload);

}  // namespace crspf::mqtt
