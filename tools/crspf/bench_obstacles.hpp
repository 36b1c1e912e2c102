// What `crspf bench` measures of the obstacle scan.
#pragma once

namespace crspf::cli {

inline constexpr const char* kObstaclesVlp16 = "obstacles/vlp16";
inline constexpr const char* kObstaclesHdl64e = "obstacles/hdl64e_s2";

/// Tells Google Benchmark of a case for each model: a revolution into a scan of 720 beams. Items are revolutions.
void register_obstacle_cases();

}  // namespace crspf::cli
