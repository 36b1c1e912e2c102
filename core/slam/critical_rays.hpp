// Critical rays (paper 4.2, formulas (4) to (7)): the points where the outline of what the lidar sees bends sharply.
#pragma once

#include <array>
#include <cstdint>

#include "config/capacities.hpp"
#include "core/slam/scan_points.hpp"
#include "core/slam/slam_params.hpp"

namespace crspf {

/// Finds the critical rays of a scan. Linear in the points times the window squared; no heap, no throw. One owner.
///
/// The chain of points is broken where a beam is missing and where two neighbours are too far apart for one surface
/// seen at 10 degrees, so that an occlusion's edge is no corner. An arm shorter than three times the range noise says
/// nothing about an angle and is left out. Of equally sharp neighbours the first one wins, so that a run of equal
/// angles gives one critical ray, not none and not all.
class CriticalRays {
 public:
    explicit CriticalRays(const CriticalRaysParams& params, double range_noise_m)
        : params_(params), range_noise_m_(range_noise_m) {}

    /// Sets `critical[i]` for each hit of `points`; returns how many there are.
    std::uint32_t select(const ScanPoints& points, std::array<bool, capacity::kBeams>& critical);

 private:
    static constexpr int kWindow = 16;  ///< the largest window_max

    void measure_chain(const ScanPoints& points, std::uint32_t begin, std::uint32_t end);

    CriticalRaysParams params_;
    double range_noise_m_;
    /// Cosine of the smallest opening angle of (7); -1, a straight line, where there is none.
    std::array<float, capacity::kBeams> sharpness_{};
    /// Unit vectors from point i to point i + d, by d = window_min .. window_max and i; NaN where the arm is too short.
    /// Rows a power of two apart would fight for the same lines of the cache.
    static constexpr std::size_t kRow = capacity::kBeams + 16;
    using PerArm = std::array<std::array<float, kRow>, kWindow + 1>;
    PerArm arm_x_{};
    PerArm arm_y_{};
};

}  // namespace crspf
