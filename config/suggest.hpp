// What a misspelt name of the configuration file was probably meant to be.
#pragma once

#include <span>
#include <string>
#include <string_view>

namespace crspf {

/// A remedy for the unknown `key` of the known section `table`: the nearest key of that section by spelling, with units
/// left out of the comparison; else a section that has this very key; else where to find the list of keys.
[[nodiscard]] std::string remedy_for_key(std::string_view table, std::string_view key);

/// The same for a name that is to be one of `names`.
[[nodiscard]] std::string remedy_for_name(std::string_view name, std::span<const std::string_view> names);

/// A remedy for an unknown table, or for a key outside any table.
[[nodiscard]] std::string remedy_for_table(std::string_view name);

}  // namespace crspf
