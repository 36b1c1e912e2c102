// What a source counts, by name.
#pragma once

#include <cstdint>
#include <utility>
#include <vector>

namespace crspf {

/// In the order in which they are shown.
using SourceCounts = std::vector<std::pair<const char*, std::uint64_t>>;

}  // namespace crspf
