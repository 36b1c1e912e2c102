#include "platform/capture/scan_beams.hpp"

#include <algorithm>

namespace crspf {

void finish_scan(Scan& scan, double angle_min_rad, double angle_increment_rad, double time_per_beam_s,
                 const LidarParams& lidar) {
    scan.stamp = Stamp{} + Duration::from_seconds(lidar.stamp_offset_s);
    scan.time_per_beam_s = time_per_beam_s;
    scan.angle_min_rad = angle_min_rad;
    scan.angle_increment_rad = angle_increment_rad;
    if (!lidar.mount_inverted) {
        return;
    }
    const double steps = static_cast<double>(scan.count) - 1.0;
    scan.stamp = scan.stamp + Duration::from_seconds(steps * time_per_beam_s);
    scan.time_per_beam_s = -time_per_beam_s;
    scan.angle_min_rad = -(angle_min_rad + steps * angle_increment_rad);
    const auto count = static_cast<std::ptrdiff_t>(scan.count);
    std::reverse(scan.range_m.begin(), scan.range_m.begin() + count);
    std::reverse(scan.beam.begin(), scan.beam.begin() + count);
}

}  // namespace crspf
