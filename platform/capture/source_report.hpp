// How much a source had to say, and what its driver counted.
#pragma once

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

namespace crspf {

/// By name, in the order in which they are shown.
using SourceCounts = std::vector<std::pair<const char*, std::uint64_t>>;

struct SourceReport {
    std::string name;
    std::uint64_t records = 0;
    SourceCounts counts;
};

/// "lidar: 293 records, foreign 293": what is not 0.
[[nodiscard]] std::string text_of(const SourceReport& source);

}  // namespace crspf
