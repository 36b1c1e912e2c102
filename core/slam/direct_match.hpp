// Formula (10) as printed, from the map's pixels: 25 cells a ray. The reference that proofs and benchmarks hold the
// match field against; the filter does not use it.
#pragma once

#include "core/base/pose.hpp"
#include "core/slam/match_field.hpp"
#include "core/slam/occupancy.hpp"

namespace crspf {

/// m of (10), 0 to kMatchMax; 0 without rays. Critical rays weigh `critical_weight`, ordinary ones 1.
///
/// A ray is placed into a cell as a FieldView around `P_map_base` places it, in single precision, so that the result
/// equals the match field's bit for bit as long as the view was made from a pose in the same tile.
/// @param P_map_base inside the map's extent. Wait-free, linear in the points.
[[nodiscard]] double direct_match(const OccupancyMap& map, const FieldPoints& critical, const FieldPoints& ordinary,
                                  double critical_weight, const Pose2& P_map_base, double cells_per_metre);

}  // namespace crspf
