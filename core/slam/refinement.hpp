// Below the cell (beyond the paper): the optimum refined on the interpolated field, and the shape of the match around
// it turned into a covariance and a degeneracy verdict.
#pragma once

#include <cstdint>

#include "core/base/pose.hpp"
#include "core/slam/match_objective.hpp"

namespace crspf {

/// What the scan says about each direction of the plane at the optimum.
struct MatchShape {
    Covariance3 covariance;  ///< of the pose: match and odometry together
    double weakest_x = 1.0;  ///< direction least seen by the scan: unit vector in the map frame
    double weakest_y = 0.0;
    double weakest_ratio = 1.0;  ///< information along it over information across it [0 .. 1]
    bool degenerate = false;     ///< the ratio is below the configured bound: along it the scan sees nothing
};

/// Result of a refinement.
struct Refined {
    Pose2 P_map_base;
    std::uint32_t evaluations = 0;  ///< passes over the rays
};

/// The most passes over the rays of a climb.
inline constexpr std::uint32_t kClimbPasses = 6;

/// Both climb the interpolated field with the pull towards P~. A step is taken only where the score rises. No heap, no
/// throw.
///
/// In strides of up to 5 cm and 1 deg, from the observed pose: where the particles start their search.
[[nodiscard]] Refined approach(const MatchObjective& objective, const Pose2& start);
/// To the top below the cell size, from the filter's best particle.
[[nodiscard]] Refined refine(const MatchObjective& objective, const Pose2& start);

/// The shape of the match at `P_map_base`, from its drop a little to all sides: 15 evaluations.
inline constexpr std::uint32_t kShapeEvaluations = 15;
[[nodiscard]] MatchShape match_shape(const MatchObjective& objective, const Pose2& P_map_base, double resolution_m,
                                     double degenerate_below);

/// `found` with the odometry's word along the direction that the scan does not see.
[[nodiscard]] Pose2 keep_odometry_along(const MatchShape& shape, const Pose2& found, const Pose2& observed);

}  // namespace crspf
