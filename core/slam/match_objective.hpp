// What a pose is worth (paper 4.3, formula (10)): the match value of the scan there, less a pull towards the odometry.
#pragma once

#include <array>
#include <cstdint>

#include "config/capacities.hpp"
#include "core/base/pose.hpp"
#include "core/odometry/odometry.hpp"
#include "core/slam/match_field.hpp"
#include "core/slam/match_slopes.hpp"
#include "core/slam/scan_points.hpp"
#include "core/slam/slam_params.hpp"
#include "core/slam/surface_normals.hpp"

namespace crspf {

/// The scan's rays as the field wants them, critical rays first, and the odometry's word. One scan at a time:
/// load(), aim(), then any number of evaluations. No heap, no throw. One owner.
class MatchObjective {
 public:
    MatchObjective(const SlamParams& params, Kernel kernel);

    /// Takes the rays of a scan. Rays farther than the field's reach are left out.
    /// @param normals of the same points
    void load(const ScanPoints& points, const std::array<bool, capacity::kBeams>& critical,
              const SurfaceNormals& normals);
    /// Takes the field and the observed pose P~ with its uncertainty. False outside the map's extent.
    /// @param heading_trust how far the odometry's heading counts beside its position, 0 to 1
    [[nodiscard]] bool aim(const MatchField& field, const Pose2& P_map_observed, const MotionPrior& prior,
                           double heading_trust = 0.0);

    /// m of (10) at a pose, 0 to kMatchMax. One look-up a ray.
    [[nodiscard]] double match(const Pose2& P_map_base) const;
    /// m of (10) over the rays that fall on cells which the map has seen: a ray into unseen land says nothing about the
    /// pose. Negative when they carry less than a fifth of the weight: no verdict.
    [[nodiscard]] double match_seen(const Pose2& P_map_base) const;
    /// What the search maximises: m as a fraction of kMatchMax, less the pull.
    [[nodiscard]] double score(const Pose2& P_map_base) const {
        return match(P_map_base) / kMatchMax - pull(P_map_base);
    }

    /// The pull towards P~: grows with the squared distance d^2 in standard deviations of the odometry and saturates,
    /// w d^2 / (1 + d^2 / s), so that it lets go when the odometry itself is wrong (slip, a lost sample). The heading
    /// has its part as far as it is trusted.
    [[nodiscard]] double pull(const Pose2& P_map_base) const;
    /// Half the second derivative of the pull, by position; the heading has no part in it. [1/m^2]
    [[nodiscard]] double pull_curvature(const Pose2& P_map_base) const;

    /// The match on the interpolated field, as a fraction f of kMatchMax, and how it changes with the pose; means over
    /// the rays by weight, in the order x, y, theta; units m and rad.
    ///
    /// A ray on a straight surface counts across the surface only: what the field says along it (the ends of what has
    /// been drawn so far, gaps between far hits) lies still as seen from the robot and would hold it back. Critical
    /// rays and rays without a surface count in all directions.
    struct Linearized {
        double match = 0.0;
        std::array<double, 3> slope{};    ///< of the match
        std::array<double, 3> missing{};  ///< of -(1 - f)^2 / 2: rays that match badly pull more
        Covariance3 information;          ///< mean of J^T J
        double steepness = 0.0;           ///< slope of a typical ray that has one [1/cell]
    };
    [[nodiscard]] Linearized linearize(const Pose2& P_map_base) const;

    /// How far from P~ along each axis a pose may be so that every look-up stays in the field's window. [m]
    [[nodiscard]] double reach_m() const { return reach_m_; }
    /// Root mean square distance of the rays' ends from base_link. [m]
    [[nodiscard]] double rms_range_m() const { return rms_range_m_; }
    /// Rays in use: N_s of the paper.
    [[nodiscard]] std::uint32_t rays() const { return critical_.count + ordinary_.count; }
    [[nodiscard]] std::uint32_t critical_rays() const { return critical_.count; }
    [[nodiscard]] const Pose2& observed() const { return observed_; }
    [[nodiscard]] const MotionPrior& prior() const { return prior_; }

 private:
    double pull_weight_;
    double pull_saturation_;
    double critical_weight_;
    double cells_per_metre_;
    FieldSum sum_;
    SlopeSum slope_sum_;
    FieldPoints critical_;
    FieldPoints ordinary_;
    double weight_sum_ = 0.0;
    double reach_m_ = 0.0;
    double rms_range_m_ = 0.0;
    FieldView view_;
    Pose2 observed_;
    MotionPrior prior_;
    double translation_precision_ = 0.0;  ///< [1/m^2]
    double rotation_precision_ = 0.0;     ///< [1/rad^2] by the trust
    RayTable rays_;                       ///< critical rays first
};

}  // namespace crspf
