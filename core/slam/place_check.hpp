// How much of a scan a pose explains, looked up on the map itself, beam by beam.
#pragma once

#include <cstdint>

#include "core/base/pose.hpp"
#include "core/slam/map_view.hpp"
#include "core/slam/sparse_scan.hpp"

namespace crspf {

/// Refers to a map and a scan, which must outlive it. No heap, no throw; deterministic.
class PlaceCheck {
 public:
    /// @param tolerance_m hits at this distance from a wall and farther are not explained by it; rounded to cells
    PlaceCheck(const MapView& map, const SparseScan& scan, double tolerance_m);

    /// The share of the hits that lie on a wall which their beam can have reached [0 .. 1]. A hit counts less, ring by
    /// ring, beside the wall. A beam that the map stops at a wall before its hit counts nothing, and so does one that
    /// runs mostly through unseen land; but it may run to the side by the tolerance, so that a wall which it grazes
    /// does not stop it. Linear in the cells under the beams.
    [[nodiscard]] double share(const Pose2& P_corner_lidar) const;

    /// A place climbed to the top of its hill, by hits alone: beams that graze walls would make it rough.
    struct Climbed {
        Pose2 P_corner_lidar;
        std::uint32_t evaluations = 0;  ///< passes over the hits; at most kClimbEvaluations
    };
    static constexpr std::uint32_t kClimbEvaluations = 1 + 6 * 30;
    /// @param step_m,step_rad the first steps: about how far the top may be
    [[nodiscard]] Climbed climb(const Pose2& P_corner_lidar, double step_m, double step_rad) const;

 private:
    struct Point {
        double x;
        double y;
    };

    template <typename Counts>
    [[nodiscard]] std::int32_t sum(const Pose2& P_corner_lidar, Counts&& counts) const;
    [[nodiscard]] std::int32_t worth_at(Point hit) const;
    [[nodiscard]] bool can_see(Point from, Point to) const;
    [[nodiscard]] bool is_open(Point from, Point to) const;

    const MapView& map_;
    const SparseScan& scan_;
    double cells_per_metre_;
    std::int32_t reach_;  ///< [cells]
};

}  // namespace crspf
