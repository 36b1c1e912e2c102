// What `crspf top` shows: two status answers of the service, one after the other, as lines of text.
#pragma once

#include <cstddef>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

namespace crspf::cli {

/// @param status as `crspf ctl status` gives it, version 1
/// @param before an earlier one, for rates; null: there is none
/// @param columns lines are cut to so many characters
[[nodiscard]] std::vector<std::string> top_screen(const nlohmann::ordered_json& status,
                                                  const nlohmann::ordered_json& before, std::size_t columns);

}  // namespace crspf::cli
