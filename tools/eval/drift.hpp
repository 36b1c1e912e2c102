// How far a trajectory drifts with the way it goes: the measure of KITTI's odometry benchmark.
#pragma once

#include <Eigen/Geometry>
#include <cstddef>
#include <span>
#include <vector>

namespace crspf::eval {

/// What of every stretch of one length goes wrong, on average.
struct DriftAtLength {
    double length_m = 0.0;
    std::size_t stretches = 0;
    double translation = 0.0;  ///< [m/m] error of the position at its end, by its length
    double rotation_deg_per_m = 0.0;
};

struct Drift {
    double path_m = 0.0;                 ///< of the truth
    std::vector<DriftAtLength> lengths;  ///< those that fit
    /// Over all stretches of all lengths.
    std::size_t stretches = 0;
    double translation = 0.0;
    double rotation_deg_per_m = 0.0;
    /// At the end of the run, with the first poses laid on each other.
    double end_translation = 0.0;
    double end_rotation_deg_per_m = 0.0;
};

/// KITTI's: 100, 200 ... 800 m, and a stretch begins at every tenth pose. Where the path is shorter than the shortest
/// of them: 10, 20 ... m, and at every pose.
[[nodiscard]] std::vector<double> kitti_lengths_m(double path_m);
[[nodiscard]] std::size_t kitti_step(double path_m);

/// Poses of the same moments; not fewer than two. A stretch ends at the first pose that is `length` of the true way on.
[[nodiscard]] Drift drift(std::span<const Eigen::Isometry3d> trajectory, std::span<const Eigen::Isometry3d> truth,
                          std::span<const double> lengths_m, std::size_t step);

/// [m] along it
[[nodiscard]] double path_length_m(std::span<const Eigen::Isometry3d> trajectory);

}  // namespace crspf::eval
