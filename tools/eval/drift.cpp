#include "tools/eval/drift.hpp"

#include <algorithm>

#include "core/base/trig.hpp"

namespace crspf::eval {

namespace {

constexpr double kShortest_m = 100.0;
constexpr int kLengths = 8;

std::vector<double> way(std::span<const Eigen::Isometry3d> trajectory) {
    std::vector<double> sum{0.0};
    for (std::size_t i = 1; i < trajectory.size(); ++i) {
        sum.push_back(sum.back() + (trajectory[i].translation() - trajectory[i - 1].translation()).norm());
    }
    return sum;
}

struct Error {
    double position_m;
    double turn_deg;
};

Error error_of(const Eigen::Isometry3d& step, const Eigen::Isometry3d& true_step) {
    const Eigen::Isometry3d rest = step.inverse() * true_step;
    return {.position_m = rest.translation().norm(), .turn_deg = degrees(Eigen::AngleAxisd(rest.rotation()).angle())};
}

}  // namespace

std::vector<double> kitti_lengths_m(double path_m) {
    const double unit_m = path_m < kShortest_m ? kShortest_m / 10.0 : kShortest_m;
    std::vector<double> lengths;
    for (int i = 1; i <= kLengths; ++i) {
        lengths.push_back(unit_m * i);
    }
    return lengths;
}

std::size_t kitti_step(double path_m) {
    return path_m < kShortest_m ? 1 : 10;
}

double path_length_m(std::span<const Eigen::Isometry3d> trajectory) {
    return way(trajectory).back();
}

Drift drift(std::span<const Eigen::Isometry3d> trajectory, std::span<const Eigen::Isometry3d> truth,
            std::span<const double> lengths_m, std::size_t step) {
    const std::vector<double> along = way(truth);
    Drift out{.path_m = along.back(), .lengths = {}};
    for (const double length_m : lengths_m) {
        DriftAtLength at{.length_m = length_m};
        for (std::size_t first = 0; first < truth.size(); first += step) {
            const auto end = std::lower_bound(along.begin(), along.end(), along[first] + length_m);
            if (end == along.end()) {
                break;
            }
            const auto last = static_cast<std::size_t>(end - along.begin());
            const Error error =
                error_of(trajectory[first].inverse() * trajectory[last], truth[first].inverse() * truth[last]);
            at.translation += error.position_m / length_m;
            at.rotation_deg_per_m += error.turn_deg / length_m;
            ++at.stretches;
        }
        if (at.stretches == 0) {
            continue;
        }
        out.stretches += at.stretches;
        out.translation += at.translation;
        out.rotation_deg_per_m += at.rotation_deg_per_m;
        at.translation /= static_cast<double>(at.stretches);
        at.rotation_deg_per_m /= static_cast<double>(at.stretches);
        out.lengths.push_back(at);
    }
    if (out.stretches > 0) {
        out.translation /= static_cast<double>(out.stretches);
        out.rotation_deg_per_m /= static_cast<double>(out.stretches);
    }
    if (out.path_m > 0.0) {
        const Error error =
            error_of(trajectory.front().inverse() * trajectory.back(), truth.front().inverse() * truth.back());
        out.end_translation = error.position_m / out.path_m;
        out.end_rotation_deg_per_m = error.turn_deg / out.path_m;
    }
    return out;
}

}  // namespace crspf::eval
