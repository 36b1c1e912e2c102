#include "drivers/common/mounted_scan.hpp"

#include <algorithm>
#include <span>

namespace crspf {

void mount(Scan& scan, const LidarParams& lidar) {
    for (std::uint32_t i = 0; i < scan.count; ++i) {
        if (scan.beam[i] == Beam::kHit) {
            scan.beam[i] = classify(scan.range_m[i], lidar);
        }
    }
    scan.stamp = scan.stamp + Duration::from_seconds(lidar.stamp_offset_s);
    if (lidar.mount_inverted && scan.count > 0) {
        const double last = scan.count - 1.0;
        std::reverse(scan.range_m.begin(), scan.range_m.begin() + scan.count);
        std::reverse(scan.beam.begin(), scan.beam.begin() + scan.count);
        scan.stamp = scan.stamp + Duration::from_seconds(last * scan.time_per_beam_s);
        scan.angle_min_rad = -(scan.angle_min_rad + last * scan.angle_increment_rad);
        scan.time_per_beam_s = -scan.time_per_beam_s;
    }
}

}  // namespace crspf
