#include "core/slam/particle_filter.hpp"

#include <algorithm>
#include <array>
#include <utility>

#include "core/slam/refinement.hpp"

namespace crspf {
namespace {

// Lines 30 and 31 of the algorithm box.
constexpr double kPoseDiscount = 0.3;
constexpr double kAngleDiscount = 0.2;
// What the refinement may move the pose by afterwards.
constexpr double kRefinement_m = 0.3;
// A climb reaches as far to both sides.
constexpr double kClimbFrom_m = 0.1;
constexpr std::array<std::pair<double, double>, 8> kDirections{
    {{1.0, 0.0}, {-1.0, 0.0}, {0.0, 1.0}, {0.0, -1.0}, {1.0, 1.0}, {1.0, -1.0}, {-1.0, 1.0}, {-1.0, -1.0}}};

}  // namespace

double feedback(double match, double match_min, double match_max, double at_best, double at_worst) {
    const double m = std::clamp(match, match_min, match_max);
    return (match_max - match_min) * at_worst * at_best /
           ((at_worst - at_best) * m - (match_min * at_worst - match_max * at_best));
}

/// An odometer that was blind has guessed the way. Between long walls a match along it is a narrow one, which particles
/// hardly hit: the climb begins from places round P~, too, the nearest first.
double ParticleFilter::seek_guessed_way(const MatchObjective& objective, double farthest_m, Particle& best) const {
    const double doubt_m = std::min(params_.range_stddevs * objective.prior().told_stddev_m, farthest_m);
    const auto rings = static_cast<int>(doubt_m / kClimbFrom_m);
    for (int ring = 1; ring <= rings; ++ring) {
        for (const auto& [ahead, left] : kDirections) {
            if (best.evaluations + kClimbPasses >= params_.evaluations_max / 2) {
                return ring * kClimbFrom_m;
            }
            const Pose2 P_observed_start{.x_m = ring * kClimbFrom_m * ahead, .y_m = ring * kClimbFrom_m * left};
            const Refined found = approach(objective, objective.observed() * P_observed_start);
            const double score = objective.score(found.P_map_base);
            best.evaluations += found.evaluations + 1;
            if (score > best.score) {
                best.P_map_base = found.P_map_base;
                best.score = score;
            }
        }
    }
    return rings * kClimbFrom_m;
}

Particle ParticleFilter::search(const MatchObjective& objective, double M_previous) {
    const double m = params_.feedback ? M_previous : params_.match_min;
    const auto by_match = [&](double at_best, double at_worst) {
        return feedback(m, params_.match_min, params_.match_max, at_best, at_worst);
    };
    double range_m = by_match(params_.range_min_m, params_.range_max_m);
    double angle_rad = by_match(params_.angle_min_rad, params_.angle_max_rad);
    // Beyond (9): a search never spans less than the odometry's own uncertainty, and a wider one has more particles.
    const MotionPrior& prior = objective.prior();
    const double widen = std::max({1.0, params_.range_stddevs * prior.translation_stddev_m / range_m,
                                   params_.range_stddevs * prior.rotation_stddev_rad / angle_rad});
    range_m = std::max(range_m, params_.range_stddevs * prior.translation_stddev_m);
    angle_rad = std::max(angle_rad, params_.range_stddevs * prior.rotation_stddev_rad);
    const double particles =
        widen * by_match(static_cast<double>(params_.particles_min), static_cast<double>(params_.particles_max));
    // A third of it counts below: more than three times the bound makes no difference, and might not fit.
    const auto loopnum = static_cast<std::uint32_t>(std::min(particles, 3.0 * params_.evaluations_max));

    Particle best{.P_map_base = objective.observed(), .score = objective.score(objective.observed()), .evaluations = 1};
    if (params_.refinement && best.evaluations + kClimbPasses < params_.evaluations_max) {
        const Refined near = approach(objective, objective.observed());
        const double score = objective.score(near.P_map_base);
        best.evaluations += near.evaluations + 1;
        if (score > best.score) {
            best.P_map_base = near.P_map_base;
            best.score = score;
        }
    }
    const double room_m = std::max(objective.reach_m() - kRefinement_m, 0.0);
    const double sought_m = params_.refinement ? seek_guessed_way(objective, 0.5 * room_m, best) : 0.0;
    // The ranges of all rounds add up to range / (1 - discount); after a long drive without scans that could be
    // anywhere.
    range_m = std::min(range_m, (1.0 - kPoseDiscount) * (room_m - sought_m));
    best.range_m = range_m;
    best.range_rad = angle_rad;
    Particle centre = best;
    std::uint32_t failures = 0;
    while (failures < loopnum && range_m >= finest_m_ && best.evaluations < params_.evaluations_max) {
        const Pose2 candidate{.x_m = centre.P_map_base.x_m + range_m * rng_.symmetric(),
                              .y_m = centre.P_map_base.y_m + range_m * rng_.symmetric(),
                              .theta_rad = wrap_angle(centre.P_map_base.theta_rad + angle_rad * rng_.symmetric())};
        const double score = objective.score(candidate);
        ++best.evaluations;
        if (score > best.score) {
            best.P_map_base = candidate;
            best.score = score;
            continue;
        }
        ++failures;
        if (failures > loopnum / 3 && best.score > centre.score) {
            failures = 0;
            range_m *= kPoseDiscount;
            angle_rad *= kAngleDiscount;
            centre = best;
        }
    }
    return best;
}

}  // namespace crspf
