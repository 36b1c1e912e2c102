#include "platform/crspfd/pose_composer.hpp"

#include <algorithm>
#include <cmath>

namespace crspf {

namespace {

/// `from` on its way to `to`, no farther than the limits.
Pose2 step_towards(const Pose2& from, const Pose2& to, double distance_max_m, double turn_max_rad) {
    const double dx = to.x_m - from.x_m;
    const double dy = to.y_m - from.y_m;
    const double distance = std::hypot(dx, dy);
    const double share = distance > distance_max_m ? distance_max_m / distance : 1.0;
    const double turn = wrap_angle(to.theta_rad - from.theta_rad);
    return {.x_m = from.x_m + share * dx,
            .y_m = from.y_m + share * dy,
            .theta_rad = wrap_angle(from.theta_rad + std::clamp(turn, -turn_max_rad, turn_max_rad))};
}

}  // namespace

PoseReport PoseComposer::compose(Stamp now, const OdometryState& odometry, const FilterState& filter) {
    const Duration stale = Duration::from_seconds(config_.odometry_stale_s);
    const Duration odometry_age = now - odometry.stamp;
    const bool odometry_lives = odometry.stamp > Stamp{} && odometry_age <= stale;
    // A sample's stamp may be a little in the future of this clock; what is too old is not extrapolated any further.
    const double ahead_s = std::clamp(odometry_age, Duration{}, stale).seconds();
    const Pose2 P_odom_base = odometry.P_odom_base * Pose2{.x_m = odometry.speed_mps * ahead_s,
                                                           .y_m = 0.0,
                                                           .theta_rad = wrap_angle(odometry.yaw_rate_radps * ahead_s)};
    follow(odometry.P_map_odom, P_odom_base, begun_ ? (now - last_).seconds() : 0.0, odometry.jumps != odometry_jumps_);
    odometry_jumps_ = odometry.jumps;
    last_ = now;

    const ScanResult& scan = filter.result;
    PoseReport report;
    report.P_map_base = P_map_odom_ * P_odom_base;
    report.speed_mps = odometry_lives ? odometry.speed_mps : 0.0;
    report.yaw_rate_radps = odometry_lives ? odometry.yaw_rate_radps : 0.0;
    report.covariance = scan.shape.covariance;
    report.M = scan.M;
    report.age = scan.stamp > Stamp{} ? now - scan.stamp : kNoScanYet;
    const bool scan_lives = report.age <= Duration::from_seconds(config_.match_stale_s);
    report.matched = scan_lives && scan.matched;
    report.result = report.matched && scan.result;
    report.degenerate = report.matched && scan.shape.degenerate;
    // A motion that has been guessed for so long is believed where the scans confirm it, in every direction.
    const bool guessed = odometry.blind_since > Stamp{} && now - odometry.blind_since > stale;
    report.lost = !odometry_lives || !scan_lives || scan.lost || (guessed && (!report.result || report.degenerate));
    report.resets = resets_;
    ++counters_.poses;
    counters_.lost += report.lost ? 1 : 0;
    return report;
}

void PoseComposer::follow(const Pose2& P_map_odom, const Pose2& P_odom_base, double dt_s, bool placed) {
    const Pose2 from = P_map_odom_ * P_odom_base;
    const Pose2 to = P_map_odom * P_odom_base;
    const bool far = std::hypot(to.x_m - from.x_m, to.y_m - from.y_m) > config_.jump_m ||
                     std::abs(wrap_angle(to.theta_rad - from.theta_rad)) > config_.jump_rad;
    if (begun_ && (placed || far)) {
        ++resets_;
        ++counters_.jumps;
    }
    if (!begun_ || placed || far) {
        begun_ = true;
        P_map_odom_ = P_map_odom;
        return;
    }
    // The limits are of the robot's pose: a little turn of P_map_odom moves a robot that is far from the origin a lot.
    P_map_odom_ =
        step_towards(from, to, config_.correction_mps * dt_s, config_.correction_radps * dt_s) * inverse(P_odom_base);
}

}  // namespace crspf
