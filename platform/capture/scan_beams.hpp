// What all log formats do to turn ranges into a Scan.
#pragma once

#include <cstddef>

#include "core/base/lidar_params.hpp"
#include "core/base/samples.hpp"

namespace crspf {

/// @param i below capacity::kBeams
inline void set_beam(Scan& scan, std::size_t i, float range_m, const LidarParams& lidar) {
    scan.range_m[i] = range_m;
    scan.beam[i] = classify(range_m, lidar);
}

/// Ends a scan whose beams and count are set, in the order in which they were measured, counter-clockwise in the
/// sensor's eyes. Sets the rest; the stamp counts from the one that was recorded, so that of the first beam measured is
/// lidar.stamp_offset_s. A sensor that hangs upside down is turned round: its last beam becomes beam 0, and time runs
/// backwards along the beams.
void finish_scan(Scan& scan, double angle_min_rad, double angle_increment_rad, double time_per_beam_s,
                 const LidarParams& lidar);

}  // namespace crspf
