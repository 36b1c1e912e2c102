// Scan matching with feedback (paper 4.3): the algorithm box with formulas (8) and (9).
#pragma once

#include <cstdint>

#include "core/base/rng.hpp"
#include "core/slam/match_objective.hpp"
#include "core/slam/slam_params.hpp"

namespace crspf {

/// Formula (9): the inverse proportion through (match_min, at_worst) and (match_max, at_best); `match` is clamped to
/// that interval first.
[[nodiscard]] double feedback(double match, double match_min, double match_max, double at_best, double at_worst);

/// The best particle of a search.
struct Particle {
    Pose2 P_map_base;
    double score = 0.0;             ///< of MatchObjective
    std::uint32_t evaluations = 0;  ///< spent on the search
    double range_m = 0.0;           ///< [m] half the width of the first round, along each axis
    double range_rad = 0.0;         ///< [rad] and in heading
};

/// No heap, no throw; at most evaluations_max evaluations. The same seed and inputs give the same particles.
class ParticleFilter {
 public:
    /// @param resolution_m of the map: a search narrower than a cell is left to the refinement, where there is one
    ParticleFilter(const ParticleFilterParams& params, double resolution_m)
        : params_(params), finest_m_(params.refinement ? resolution_m : 0.0), rng_(params.seed) {}

    /// Searches around the observed pose P~ of `objective`, or where approach() leads from it if that matches better.
    /// @param M_previous M(t-1), on the scale of (10)
    [[nodiscard]] Particle search(const MatchObjective& objective, double M_previous);

 private:
    /// @return how far from P~ along each axis it sought; at most `farthest_m`
    double seek_guessed_way(const MatchObjective& objective, double farthest_m, Particle& best) const;

    ParticleFilterParams params_;
    double finest_m_;
    Rng rng_;
};

}  // namespace crspf
