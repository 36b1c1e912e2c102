// k-nearest-neighbour map error: how far the walls of a built map lie from the true ones. After J. M. Santos,
// D. Portugal, R. P. Rocha, "An evaluation of 2D SLAM techniques available in Robot Operating System", SSRR 2013.
//
// Both maps are taken as the centres of their occupied cells. The built map is first resampled to the truth's
// resolution (to coarser cells: occupied where any of its cells is) and then laid on the truth by a rigid alignment.
// Distances are exact, between centres, not rounded to cells.
#pragma once

#include "core/base/pose.hpp"
#include "platform/files/grid_map.hpp"
#include "tools/eval/summary.hpp"

namespace crspf::eval {

/// The alignment turns and moves the built map about the mean of its occupied cells, within these bounds.
struct AlignmentWindow {
    Pose2 P_truth_built{};                 ///< middle of the window
    double half_width_m = 2.0;             ///< [m] >= 0, along both axes of the truth's grid; 0 with
    double half_turn_rad = radians(20.0);  ///< [rad] in [0, pi]; 0: no alignment, P_truth_built is taken as it is
};

struct MapError {
    Pose2 P_truth_built;          ///< the alignment found
    bool at_window_edge = false;  ///< the best alignment may lie outside the window
    bool lies_elsewhere = false;  ///< half of the built cells are beyond the cut-off: the alignment was not found
    double cell_m = 0.0;          ///< [m] resolution of the truth, to which the built map was resampled
    Summary built_to_truth_m;     ///< from each occupied built cell to the nearest true one; blind to missing walls
    Summary truth_to_built_m;     ///< from each occupied true cell to the nearest built one; blind to surplus walls

    /// The figure by which the metric is usually reported: the distances of all built cells, divided by the number of
    /// true cells. A wall that was built twice counts twice. [m]
    [[nodiscard]] double sum_per_truth_cell_m() const {
        return built_to_truth_m.mean * static_cast<double>(built_to_truth_m.count) /
               static_cast<double>(truth_to_built_m.count);
    }
};

/// Both maps have at least one occupied cell, else std::invalid_argument. The alignment is the rigid transform with the
/// least mean distance from the built cells to the truth, each distance cut off at 0.5 m (or 5 cells), so that walls
/// which were built twice or astray do not pull the rest: an exhaustive search of the window in steps of 0.2 m (or 2
/// cells), then damped Gauss-Newton from the best places. Throws InputError when the window or the resampled map is too
/// large to search.
[[nodiscard]] MapError map_error(const GridMap& built, const GridMap& truth, const AlignmentWindow& window);

}  // namespace crspf::eval
