// A scan thinned to hits about a step apart, seen from its lidar: what a search over a whole map can afford to look at.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "core/slam/scan_points.hpp"

namespace crspf {

/// Frame: the lidar at the scan's first beam.
struct SparseScan {
    static constexpr std::uint32_t kHits = 256;

    std::uint32_t count = 0;
    std::array<float, kHits> x_m{};
    std::array<float, kHits> y_m{};
    double rms_range_m = 0.0;

    /// Takes hits that are `apart_m` or more from the one taken before: else the wall beside the robot speaks for most
    /// of the scan. Of more than kHits every second, third ... is taken. Hits farther than 1 km or not finite are left
    /// out. Linear in the hits; no heap, no throw.
    void take(const ScanPoints& points, double apart_m);
};

}  // namespace crspf
