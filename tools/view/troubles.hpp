// Counters of the service's status that tell of something wrong where they are not 0.
#pragma once

#include <nlohmann/json.hpp>

namespace crspf::view {

/// Those that are not 0, and the words of what is wrong: {"filter.skipped": 3, "map.problem": "disk full"}. What the
/// document lacks is left out.
[[nodiscard]] nlohmann::ordered_json troubles_of(const nlohmann::ordered_json& status);

}  // namespace crspf::view
