// Scans of straight walls from known poses.
#pragma once

#include "tests/unit/core/synthetic.hpp"
#include "tools/eval/scan_alignment.hpp"

namespace crspf::test {

/// What a lidar of 180 degrees at base_link sees; noise of up to +-`noise_m` on each range.
inline eval::ScanHits wall_scan(const Walls& walls, const Pose2& P_world_base, Rng& rng, double noise_m = 0.01) {
    constexpr double kFarthest_m = 30.0;
    eval::ScanHits hits;
    hits.angle_increment_rad = radians(1.0);
    for (int beam = -90; beam < 90; ++beam) {
        const double angle_rad = radians(beam + 0.5);
        const double range_m = distance_to(walls, P_world_base, angle_rad) + noise_m * rng.symmetric();
        if (range_m < kFarthest_m) {
            const SinCos d = sin_cos(angle_rad);
            hits.points.emplace_back(static_cast<float>(range_m * d.cos), static_cast<float>(range_m * d.sin));
        }
    }
    return hits;
}

}  // namespace crspf::test
