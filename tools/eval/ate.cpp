#include "tools/eval/ate.hpp"

#include <cmath>

#include "tools/eval/stamp_index.hpp"

namespace crspf::eval {
namespace {

struct Pair {
    Pose2 estimate;  ///< in the map frame
    Pose2 truth;     ///< in the truth frame
};

Pose2 first_pose_alignment(const std::vector<Pair>& pairs) {
    return pairs.front().truth * inverse(pairs.front().estimate);
}

Pose2 best_fit_alignment(const std::vector<Pair>& pairs) {
    Pose2 mean_estimate;
    Pose2 mean_truth;
    const auto n = static_cast<double>(pairs.size());
    for (const Pair& pair : pairs) {
        mean_estimate.x_m += pair.estimate.x_m / n;
        mean_estimate.y_m += pair.estimate.y_m / n;
        mean_truth.x_m += pair.truth.x_m / n;
        mean_truth.y_m += pair.truth.y_m / n;
    }
    // In the plane the best rotation has a closed form: the angle of sum(conj(estimate) * truth) over the centred
    // positions, taken as complex numbers.
    double real_m2 = 0.0;
    double imaginary_m2 = 0.0;
    for (const Pair& pair : pairs) {
        const double ex = pair.estimate.x_m - mean_estimate.x_m;
        const double ey = pair.estimate.y_m - mean_estimate.y_m;
        const double tx = pair.truth.x_m - mean_truth.x_m;
        const double ty = pair.truth.y_m - mean_truth.y_m;
        real_m2 += ex * tx + ey * ty;
        imaginary_m2 += ex * ty - ey * tx;
    }
    constexpr double kNoSpread = 1e-6;  // [m^2] a robot that stood still: positions tell nothing about rotation
    if (std::hypot(real_m2, imaginary_m2) < kNoSpread) {
        return first_pose_alignment(pairs);
    }
    const double turn_rad = arc_tan2(imaginary_m2, real_m2);
    const Pose2 turned = Pose2{.theta_rad = turn_rad} * mean_estimate;
    return {.x_m = mean_truth.x_m - turned.x_m, .y_m = mean_truth.y_m - turned.y_m, .theta_rad = turn_rad};
}

EndError end_error(const std::vector<Pair>& pairs, const Direction& along) {
    const Pose2 end = first_pose_alignment(pairs) * pairs.back().estimate;
    const double dx_m = end.x_m - pairs.back().truth.x_m;
    const double dy_m = end.y_m - pairs.back().truth.y_m;
    return {.position_m = std::hypot(dx_m, dy_m),
            .along_m = dx_m * along.x + dy_m * along.y,
            .heading_deg = degrees(wrap_angle(end.theta_rad - pairs.back().truth.theta_rad))};
}

}  // namespace

std::optional<AteReport> absolute_trajectory_error(const std::vector<TimedPose>& trajectory,
                                                   const std::vector<TimedPose>& truth, const AteOptions& options) {
    const StampIndex index(truth);
    std::vector<Pair> pairs;
    pairs.reserve(trajectory.size());
    for (const TimedPose& pose : trajectory) {
        if (const auto place = index.nearest(pose.stamp_s, options.max_gap_s)) {
            pairs.push_back({.estimate = pose.P_map_base, .truth = truth[*place].P_map_base});
        }
    }
    if (pairs.empty()) {
        return std::nullopt;
    }
    const Pose2 P_truth_map =
        options.alignment == Alignment::kBestFit ? best_fit_alignment(pairs) : first_pose_alignment(pairs);
    std::vector<double> position_m;
    std::vector<double> heading_deg;
    for (const Pair& pair : pairs) {
        const Pose2 aligned = P_truth_map * pair.estimate;
        position_m.push_back(std::hypot(aligned.x_m - pair.truth.x_m, aligned.y_m - pair.truth.y_m));
        heading_deg.push_back(std::abs(degrees(wrap_angle(aligned.theta_rad - pair.truth.theta_rad))));
    }
    return AteReport{.unmatched = trajectory.size() - pairs.size(),
                     .P_truth_map = P_truth_map,
                     .position_m = summarise(std::move(position_m)),
                     .heading_deg = summarise(std::move(heading_deg)),
                     .end = end_error(pairs, options.along)};
}

}  // namespace crspf::eval
