#include "tools/calibrate/cutter.hpp"

#include <cmath>
#include <utility>

#include "core/base/trig.hpp"

namespace crspf::calibrate {
namespace {

// A piece ends where the vehicle has done one of these: far above the scans' noise, too short for the odometer to drift
// or for the view to change.
constexpr double kPiece_m = 1.0;
constexpr double kPiece_rad = 0.8;
constexpr double kPiece_s = 3.0;
constexpr eval::ScanWindow kWindow{.half_width_m = 0.3, .half_turn_rad = radians(6.0)};

}  // namespace

Cutter::Cutter(std::vector<Moment> way, const Pose2& P_base_lidar)
    : way_(std::move(way)), P_base_lidar_(P_base_lidar) {}

void Cutter::add(const Scan& scan, const Pose2& P_map_base) {
    const Pose2 P_map_lidar = P_map_base * P_base_lidar_;
    if (!begin_) {
        begin_ = {.stamp = scan.stamp, .P_map_lidar = P_map_lidar, .hits = hits_of(scan)};
        P_map_before_ = P_map_lidar;
        way_m_ = turn_rad_ = 0.0;
        return;
    }
    const Pose2 step = inverse(P_map_before_) * P_map_lidar;
    P_map_before_ = P_map_lidar;
    way_m_ += std::hypot(step.x_m, step.y_m);
    turn_rad_ += std::abs(step.theta_rad);
    if (way_m_ < kPiece_m && turn_rad_ < kPiece_rad && (scan.stamp - begin_->stamp).seconds() < kPiece_s) {
        return;
    }
    const Pose2 guess = inverse(begin_->P_map_lidar) * P_map_lidar;
    const eval::ScanAlignment found = eval::align_scans(begin_->hits, hits_of(scan), guess, kWindow);
    if (found.verdict == eval::AlignmentVerdict::kGood) {
        pieces_.push_back({.from = begin_->stamp, .to = scan.stamp, .P_from_to = found.P_reference_scan});
    } else {
        ++doubtful_;
    }
    begin_.reset();  // the next has a first scan of its own: no two share an error
}

eval::ScanHits Cutter::hits_of(const Scan& scan) const {
    eval::ScanHits hits;
    hits.angle_increment_rad = scan.angle_increment_rad;
    const std::optional<Pose2> first = place_at(way_, scan.stamp);
    for (std::uint32_t i = 0; i < scan.count; ++i) {
        if (scan.beam[i] != Beam::kHit) {
            continue;
        }
        Pose2 moved;
        if (scan.time_per_beam_s != 0.0 && first) {
            if (const auto then = place_at(way_, scan.stamp + Duration::from_seconds(scan.time_per_beam_s * i))) {
                moved = inverse(*first * P_base_lidar_) * (*then * P_base_lidar_);
            }
        }
        const SinCos direction = sin_cos(moved.theta_rad + scan.angle_min_rad + scan.angle_increment_rad * i);
        const auto range_m = static_cast<double>(scan.range_m[i]);
        hits.points.emplace_back(static_cast<float>(moved.x_m + range_m * direction.cos),
                                 static_cast<float>(moved.y_m + range_m * direction.sin));
    }
    return hits;
}

}  // namespace crspf::calibrate
