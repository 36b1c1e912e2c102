// A scan as its sensor sees it -> as it is mounted and believed.
#pragma once

#include "core/base/lidar_params.hpp"
#include "core/base/samples.hpp"

namespace crspf {

/// Ranges beyond lidar.range_max_m become no returns, nearer than range_min_m invalid; the scan of a sensor that hangs
/// upside down is turned round, its last beam becoming beam 0; stamp_offset_s is added. Wait-free.
void mount(Scan& scan, const LidarParams& lidar);

}  // namespace crspf
