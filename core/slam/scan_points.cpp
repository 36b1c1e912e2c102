#include "core/slam/scan_points.hpp"

#include <algorithm>

#include "core/base/real.hpp"

namespace crspf {
namespace {

// The robot's motion is taken as linear between so many beams: at 10 Hz and 682 beams, 5 ms.
constexpr std::uint32_t kBeamsPerKnot = 32;
// No lidar takes longer for a scan; a time per beam that says so is damaged.
constexpr double kLongestScan_s = 10.0;

}  // namespace

void ScanProjector::update_directions(const Scan& scan, std::uint32_t beams) {
    const bool same = directions_ == beams && angle_min_rad_ == scan.angle_min_rad &&
                      angle_increment_rad_ == scan.angle_increment_rad;
    if (same) {
        return;
    }
    for (std::uint32_t i = 0; i < beams; ++i) {
        const SinCos s = sin_cos(scan.angle_min_rad + static_cast<double>(i) * scan.angle_increment_rad);
        cos_[i] = s.cos;
        sin_[i] = s.sin;
    }
    directions_ = beams;
    angle_min_rad_ = scan.angle_min_rad;
    angle_increment_rad_ = scan.angle_increment_rad;
}

void ScanProjector::project(const Scan& scan, const Odometry& odometry, ScanPoints& out) {
    const std::uint32_t beams = std::min(scan.count, static_cast<std::uint32_t>(capacity::kBeams));
    update_directions(scan, beams);
    out.count = 0;
    out.clear_count = 0;
    out.beams = beams;
    out.angle_increment_rad = scan.angle_increment_rad;
    out.P_base_first_lidar = lidar_.P_base_lidar;
    out.P_base_last_lidar = lidar_.P_base_lidar;

    const double scan_time_s = absolute(beams * scan.time_per_beam_s);
    const bool moving = deskew_ && scan_time_s > 0.0 && scan_time_s <= kLongestScan_s;
    const Pose2 P_start_map = inverse(odometry.pose_at(scan.stamp));
    Pose2 knot = lidar_.P_base_lidar;
    for (std::uint32_t begin = 0; begin < beams; begin += kBeamsPerKnot) {
        const std::uint32_t end = std::min(begin + kBeamsPerKnot, beams);
        Pose2 next = knot;
        if (moving) {
            const Stamp then = scan.stamp + Duration::from_seconds(end * scan.time_per_beam_s);
            next = P_start_map * odometry.pose_at(then) * lidar_.P_base_lidar;
        }
        const SinCos heading = sin_cos(knot.theta_rad);
        const double step = 1.0 / static_cast<double>(end - begin);
        const double turn_rad = wrap_angle(next.theta_rad - knot.theta_rad);
        for (std::uint32_t i = begin; i < end; ++i) {
            const Beam kind = scan.beam[i];
            const bool ranged = kind == Beam::kHit || kind == Beam::kClear;
            if (kind == Beam::kInvalid || (ranged && classify(scan.range_m[i], lidar_) != Beam::kHit)) {
                continue;
            }
            const double u = static_cast<double>(i - begin) * step;
            // Within a knot's interval the turn is a few mrad: first order is exact to 1e-5.
            const double small_rad = u * turn_rad;
            const double c = heading.cos - small_rad * heading.sin;
            const double s = heading.sin + small_rad * heading.cos;
            const double direction_x = c * cos_[i] - s * sin_[i];
            const double direction_y = s * cos_[i] + c * sin_[i];
            const double lidar_x_m = knot.x_m + u * (next.x_m - knot.x_m);
            const double lidar_y_m = knot.y_m + u * (next.y_m - knot.y_m);
            if (kind != Beam::kHit) {
                out.clear_x_m[out.clear_count] = static_cast<float>(lidar_x_m + direction_x);
                out.clear_y_m[out.clear_count] = static_cast<float>(lidar_y_m + direction_y);
                out.clear_m[out.clear_count] = kind == Beam::kClear ? scan.range_m[i] : 0.0F;
                out.clear_beam[out.clear_count] = static_cast<std::uint16_t>(i);
                ++out.clear_count;
                continue;
            }
            const auto range_m = static_cast<double>(scan.range_m[i]);
            out.x_m[out.count] = static_cast<float>(lidar_x_m + range_m * direction_x);
            out.y_m[out.count] = static_cast<float>(lidar_y_m + range_m * direction_y);
            out.range_m[out.count] = scan.range_m[i];
            out.beam[out.count] = static_cast<std::uint16_t>(i);
            ++out.count;
        }
        knot = next;
    }
    out.P_base_last_lidar = knot;
}

}  // namespace crspf
