// The charts of the match experiment.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "core/slam/slam_params.hpp"
#include "tools/experiments/carried_run.hpp"
#include "tools/experiments/report/report.hpp"

namespace crspf::experiments {

/// The value that a share of all lies below; 0 where there are none.
[[nodiscard]] double quantile(std::vector<double> values, double share);

/// M, with the thresholds.
[[nodiscard]] Chart chart_of_match(std::string caption, std::string file, const CarriedRun& run,
                                   const AnalyserParams& analyser);
/// Result, Draw, and whether the robot is lost.
[[nodiscard]] Chart chart_of_decisions(std::string caption, const CarriedRun& run);
[[nodiscard]] Chart chart_of_error(std::string caption,
                                   const std::vector<std::pair<std::string, const CarriedRun*>>& runs);
/// (9) as it is set.
[[nodiscard]] Chart chart_of_feedback(const ParticleFilterParams& params);
/// (9) and what was spent, over a run.
[[nodiscard]] Chart chart_of_effort(const CarriedRun& run, const ParticleFilterParams& params);

}  // namespace crspf::experiments
