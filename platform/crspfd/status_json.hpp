// Parts of the status document (docs/service.md) that a replay has, too.
#pragma once

#include <nlohmann/json.hpp>

#include "core/slam/localizer.hpp"
#include "core/slam/slam_params.hpp"

namespace crspf {

/// "filter", as far as every run has it.
[[nodiscard]] nlohmann::ordered_json filter_json(const LocalizerCounters& counters, const ScanResult& last);
/// "analyser": the four thresholds.
[[nodiscard]] nlohmann::ordered_json analyser_json(const AnalyserParams& analyser);

}  // namespace crspf
