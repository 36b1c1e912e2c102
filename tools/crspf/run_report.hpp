// What the reports of recorded runs have in common.
#pragma once

#include <nlohmann/json.hpp>
#include <vector>

#include "core/odometry/odometry.hpp"
#include "platform/capture/log_reader.hpp"

namespace crspf {

/// Counts of parts of a run.
void add(LogCounts& sum, const LogCounts& part);

[[nodiscard]] nlohmann::ordered_json to_json(const OdometryCounters& counters);
[[nodiscard]] nlohmann::ordered_json to_json(const LogCounts& counts);
/// By name.
[[nodiscard]] nlohmann::ordered_json to_json(const std::vector<SourceReport>& sources);

}  // namespace crspf
