// As much of a DBC as some signals need.
#pragma once

#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace crspf {

/// A DBC of nothing but these signals, given as message and name, and what selects them. `text` is without errors.
[[nodiscard]] std::string dbc_excerpt(std::string_view text,
                                      const std::vector<std::pair<std::string_view, std::string_view>>& signals);

}  // namespace crspf
