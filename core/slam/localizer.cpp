#include "core/slam/localizer.hpp"

#include <algorithm>
#include <utility>

#include "core/base/real.hpp"

namespace crspf {

namespace {

// A robot stands while its odometry stays within this of one place. A gyroscope's drift soon leaves it.
constexpr double kStill_m = 2e-4;
constexpr double kStill_rad = 2e-4;
// How far a single scan's match lies from its pose without saying that it was moved all the same.
constexpr double kScatter_cells = 0.5;
constexpr double kScatter_rad = 0.005;

bool within(const Pose2& P, double distance_m, double angle_rad) {
    return square(P.x_m) + square(P.y_m) <= square(distance_m) && absolute(P.theta_rad) <= angle_rad;
}

}  // namespace

Localizer::Localizer(const SlamParams& params, Kernel kernel)
    : params_(params),
      odometry_(params.odometry),
      obstacles_(params.obstacles, params.lidar),
      projector_(params.lidar, params.deskew),
      critical_rays_(params.critical_rays, params.lidar.range_noise_m),
      normals_(params.lidar.range_noise_m),
      objective_(params, kernel),
      filter_(params.particle_filter, params.map.resolution_m),
      analyser_(params.analyser) {}

void Localizer::set_pose(const Pose2& P_map_base) {
    odometry_.set_pose(P_map_base);
    placed_ = true;
    confirmed_ = false;
}

void Localizer::forget_pose() {
    lost_ = true;
    placed_ = false;
    confirmed_ = false;
}

ScanResult Localizer::on_scan(const Scan& scan) {
    ScanResult out;
    out.stamp = scan.stamp;
    out.P_map_observed = odometry_.pose_at(scan.stamp);  // P~(t)
    out.P_map_base = out.P_map_observed;

    projector_.project(scan, odometry_, points_);  // de-skew
    critical_rays_.select(points_, critical_);     // (4) to (7)
    normals_.measure(points_);
    objective_.load(points_, critical_, normals_);

    match_scan(out);  // (8) to (10): P(t)
    judge(out);       // (11) to (13): Result, Draw
    if (out.matched) {
        odometry_.correct(out.stamp, out.P_map_base);  // P(t) P~(t)^-1
    } else {
        out.P_map_base = out.P_map_observed;
    }
    return out;
}

std::optional<ScanResult> Localizer::on_cloud(const Cloud& cloud) {
    return obstacles_.scan(cloud, odometry_.attitude(), obstacle_scan_) ? std::optional(on_scan(obstacle_scan_))
                                                                        : std::nullopt;
}

void Localizer::match_scan(ScanResult& out) {
    ++counters_.scans;
    out.rays = objective_.rays();
    out.critical_rays = objective_.critical_rays();
    const MotionPrior prior = odometry_.motion_between(counters_.scans > 1 ? previous_stamp_ : out.stamp, out.stamp);
    previous_stamp_ = out.stamp;
    if (static_cast<double>(out.rays) <= params_.particle_filter.points_min_fraction * points_.beams) {
        ++counters_.too_few_rays;
        return;
    }
    if (!objective_.aim(field_, out.P_map_observed, prior, heading_trust())) {
        ++counters_.outside_map;
        return;
    }
    out.matched = true;
    ++counters_.matched;

    const ParticleFilterParams& settings = params_.particle_filter;
    const Particle best = filter_.search(objective_, previous_M_);
    out.P_map_base = best.P_map_base;
    out.evaluations = best.evaluations + kShapeEvaluations;
    out.range_m = best.range_m;
    out.range_rad = best.range_rad;
    if (settings.refinement) {
        const Refined refined = refine(objective_, best.P_map_base);
        out.P_map_base = refined.P_map_base;
        out.evaluations += refined.evaluations;
    }
    out.shape = match_shape(objective_, out.P_map_base, params_.map.resolution_m, settings.degenerate_below);
    out.shape.degenerate = out.shape.degenerate && settings.degeneracy;
    if (out.shape.degenerate) {
        ++counters_.degenerate;
        out.P_map_base = keep_odometry_along(out.shape, out.P_map_base, out.P_map_observed);
    }
    stand(out);
    counters_.evaluations += out.evaluations;
}

/// Scans say the heading best, wheels worst; but where the last scan would not have been drawn, by (13), a few rays on
/// known land would turn the robot to whatever they fit.
double Localizer::heading_trust() const {
    const AnalyserParams& draw = params_.analyser;
    return std::clamp((draw.draw_on - previous_M_) / std::max(draw.draw_on - draw.draw_off, 1.0), 0.0, 1.0);
}

void Localizer::stand(ScanResult& out) {
    const Pose2 P_odom_base = inverse(odometry_.P_map_odom()) * out.P_map_observed;
    if (counters_.scans == 1 || placed_ || !within(inverse(P_odom_stop_) * P_odom_base, kStill_m, kStill_rad)) {
        P_odom_stop_ = P_odom_base;
        stopped_ = out.stamp;
    }
    if (out.stamp - stopped_ > kParked &&
        within(inverse(out.P_map_observed) * out.P_map_base, kScatter_cells * params_.map.resolution_m, kScatter_rad)) {
        ++counters_.stood;
        out.P_map_base = out.P_map_observed;
    }
}

void Localizer::judge(ScanResult& out) {
    const double m = out.matched ? objective_.match_seen(out.P_map_base) : 0.0;
    const bool new_land = m < 0.0;  // no verdict
    if (out.matched) {
        out.m = new_land ? previous_m_ : m;
        const double more = out.rays > previous_rays_ ? static_cast<double>(out.rays - previous_rays_) : 0.0;
        out.M = out.m + more / static_cast<double>(points_.beams) * previous_m_;  // (11)
        if (counters_.matched == 1) {
            out.M = out.m;
        }
    }
    previous_rays_ = out.rays;
    previous_m_ = out.m;
    previous_M_ = out.M;
    analyser_.update(out.M);
    out.result = analyser_.result();
    out.draw = analyser_.draw();
    counters_.key_frames += out.result ? 1 : 0;
    counters_.not_believed += out.draw ? 0 : 1;
    watch(out, new_land);
    // Lost or not: a map that is no longer drawn cannot be found again by a robot that was lost in error. In new land
    // nothing can be spoilt, and what is not drawn there will never match.
    out.to_draw = out.matched && (out.draw || new_land) && confirmed_ && !params_.localize_only;
    counters_.to_draw += out.to_draw ? 1 : 0;
}

void Localizer::watch(ScanResult& out, bool new_land) {
    const bool good = out.matched && out.result;
    const bool placed = std::exchange(placed_, false);
    watched_ = watched_ || good || placed;
    lost_ = lost_ && !good && !placed;
    if (good || placed || (new_land && !lost_)) {
        good_ = out.stamp;
    }
    confirmed_ = confirmed_ || good || (new_land && !lost_);
    lost_ = lost_ || (watched_ && out.stamp - good_ > kLostAfter);
    out.lost = lost_;
    counters_.lost += out.lost ? 1 : 0;
}

}  // namespace crspf
