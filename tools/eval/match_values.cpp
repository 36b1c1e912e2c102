#include "tools/eval/match_values.hpp"

#include <algorithm>
#include <cmath>
#include <memory>
#include <string>

#include "core/base/rng.hpp"
#include "core/base/trig.hpp"
#include "core/slam/critical_rays.hpp"
#include "core/slam/map_update.hpp"
#include "core/slam/match_field.hpp"
#include "core/slam/match_objective.hpp"
#include "core/slam/surface_normals.hpp"
#include "platform/files/input_error.hpp"
#include "tools/eval/logged_scans.hpp"

namespace crspf::eval {
namespace {

constexpr std::array<MatchValues, 4> kBeside = {{
    {.distance_m = 0.0, .turn_deg = 0.0},
    {.distance_m = 0.1, .turn_deg = 1.0},
    {.distance_m = 0.3, .turn_deg = 3.0},
    {.distance_m = 1.0, .turn_deg = 11.0},
}};

/// The parts of the pipeline that draw and match, without those that look for a pose.
class Matcher {
 public:
    explicit Matcher(const SlamParams& params)
        : critical_rays_(params.critical_rays, params.lidar.range_noise_m),
          normals_(params.lidar.range_noise_m),
          objective_(params, Kernel::kFastest),
          map_(params.map, params.lidar.range_noise_m) {}

    /// False: outside the map's extent.
    [[nodiscard]] bool take(const ScanPoints& points, const Pose2& P_map_base) {
        static_cast<void>(critical_rays_.select(points, critical_));
        normals_.measure(points);
        objective_.load(points, critical_, normals_);
        return objective_.aim(field_, P_map_base,
                              {.P_from_to = {}, .translation_stddev_m = 1.0, .rotation_stddev_rad = 1.0});
    }
    [[nodiscard]] double match(const Pose2& P_map_base) const { return objective_.match_seen(P_map_base); }
    void draw(const ScanPoints& points, const Pose2& P_map_base) {
        changes_.clear();
        map_.draw(points, P_map_base, true, changes_);
        field_.follow(changes_.view());
    }

 private:
    CriticalRays critical_rays_;
    SurfaceNormals normals_;
    MatchObjective objective_;
    MapUpdate map_;
    MatchField field_;
    ChangeList changes_;
    std::array<bool, capacity::kBeams> critical_{};
};

double quantile(const std::vector<double>& sorted, double share) {
    const auto last = static_cast<double>(sorted.size() - 1);
    return sorted.empty() ? 0.0 : sorted[static_cast<std::size_t>(std::lround(share * last))];
}

}  // namespace

std::array<MatchValues, 4> match_values(const std::vector<std::filesystem::path>& logs, const Config& config,
                                        const std::vector<TimedPose>& trajectory) {
    const auto matcher = std::make_unique<Matcher>(config.slam);
    std::array<std::vector<double>, kBeside.size()> values;
    Rng rng(1);
    std::size_t scans = 0;
    for_each_scan(logs, config, [&](double, const ScanPoints& points) {
        if (scans++ >= trajectory.size()) {
            return;  // said below
        }
        const Pose2& pose = trajectory[scans - 1].P_map_base;
        if (matcher->take(points, pose)) {
            for (std::size_t k = 0; k < kBeside.size(); ++k) {
                const SinCos side = sin_cos(kPi * rng.symmetric());
                const double turn_rad = radians(rng.symmetric() < 0.0 ? -kBeside[k].turn_deg : kBeside[k].turn_deg);
                const double m = matcher->match({.x_m = pose.x_m + kBeside[k].distance_m * side.cos,
                                                 .y_m = pose.y_m + kBeside[k].distance_m * side.sin,
                                                 .theta_rad = wrap_angle(pose.theta_rad + turn_rad)});
                if (m >= 0.0) {
                    values[k].push_back(m);
                }
            }
        }
        matcher->draw(points, pose);
    });
    if (scans != trajectory.size()) {
        throw InputError("the trajectory has " + std::to_string(trajectory.size()) + " poses, the logs have " +
                         std::to_string(scans) +
                         " scans; give all logs of the run, in order, and a trajectory with one pose a scan");
    }
    std::array<MatchValues, kBeside.size()> out = kBeside;
    for (std::size_t k = 0; k < out.size(); ++k) {
        std::sort(values[k].begin(), values[k].end());
        out[k].scans = values[k].size();
        out[k].p01 = quantile(values[k], 0.01);
        out[k].median = quantile(values[k], 0.5);
        out[k].p99 = quantile(values[k], 0.99);
    }
    return out;
}

}  // namespace crspf::eval
