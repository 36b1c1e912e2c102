// Robots that are carried while they make their maps: whether they notice.
#pragma once

#include <array>
#include <cstddef>
#include <functional>
#include <nlohmann/json.hpp>
#include <string>
#include <utility>
#include <vector>

#include "core/base/pose.hpp"
#include "core/slam/slam_params.hpp"
#include "tools/experiments/report/report.hpp"
#include "tools/sim/sample_drive.hpp"

namespace crspf::experiments {

/// What the odometry is told: 1.5 m each.
inline constexpr std::array<Pose2, 4> kTold{{{.x_m = 1.2, .y_m = 0.9, .theta_rad = 0.6},
                                             {.x_m = 1.5, .y_m = 0.0, .theta_rad = 0.0},
                                             {.x_m = 0.0, .y_m = 1.5, .theta_rad = 0.0},
                                             {.x_m = -1.2, .y_m = -0.9, .theta_rad = 2.0}}};
/// What became of robots that were carried while they made their maps.
struct Mapping {
    std::size_t carried = 0;
    std::size_t draw_off = 0;    ///< Draw went off within 10 s
    std::size_t lost = 0;        ///< it was taken for lost within 10 s
    std::size_t right = 0;       ///< within 10 s it was where it thought
    std::vector<double> before;  ///< M of the scan before
    std::vector<double> first;   ///< M of the first scan at the wrong pose
    std::vector<double> later;   ///< 2 s later, where the pose is wrong still
};

[[nodiscard]] Mapping carry_while_mapping(const sim::SampleDrive& drive, const SlamParams& params,
                                          const std::function<void(double)>& progress);
/// @param settings by name
[[nodiscard]] Table table_of_mapping(const std::vector<std::pair<std::string, const Mapping*>>& settings);
/// The paper, on Draw.
[[nodiscard]] Claim not_drawn(const Mapping& shipped, const Mapping& strict, const AnalyserParams& analyser,
                              const AnalyserParams& stricter);
[[nodiscard]] nlohmann::ordered_json figures_of(const Mapping& m);

}  // namespace crspf::experiments
