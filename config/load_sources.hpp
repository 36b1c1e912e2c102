// The tables [source.NAME].
#pragma once

#include <toml++/toml.h>

#include <vector>

#include "config/problems.hpp"
#include "config/sources.hpp"

namespace crspf {

/// @param node what `source` is in the document
/// @param problems takes what is wrong; what is returned is of use only where nothing was
[[nodiscard]] std::vector<SourceConfig> load_sources(const toml::node& node, Problems& problems);

}  // namespace crspf
