#include "tools/experiments/intel.hpp"

#include <algorithm>
#include <cmath>
#include <memory>
#include <utility>

#include "config/config.hpp"
#include "platform/capture/log_reader.hpp"

namespace crspf::experiments {

std::optional<IntelRun> load_intel(const std::filesystem::path& data) {
    const std::filesystem::path log = data / "carmen/intel.clf.xz";
    const std::filesystem::path relations = data / "carmen/intel.relations.xz";
    if (data.empty() || !std::filesystem::exists(log) || !std::filesystem::exists(relations)) {
        return std::nullopt;
    }
    IntelRun run;
    run.relations = eval::read_relations(relations);
    const Config config;
    run.drive.lidar = config.slam.lidar;
    const std::unique_ptr<LogReader> reader = open_log(log, config.slam.lidar, config.wheels);
    const auto event = std::make_unique<LogEvent>();
    sim::SampleDrive::Step step;
    while (reader->next(*event)) {
        if (event->kind == LogEvent::Kind::kMotion) {
            step.motions.push_back(event->motion);
        } else if (event->kind == LogEvent::Kind::kScan) {
            step.scan = event->scan;
            run.drive.steps.push_back(std::exchange(step, {}));
            run.stamps_s.push_back(event->recorded_stamp_s);
        }
    }
    return run;
}

IntelRun every_fifth(const IntelRun& run) {
    constexpr std::size_t kKept = 5;
    IntelRun out;
    out.drive.lidar = run.drive.lidar;
    sim::SampleDrive::Step step;
    for (std::size_t i = 0; i < run.drive.steps.size(); ++i) {
        const sim::SampleDrive::Step& whole = run.drive.steps[i];
        step.motions.insert(step.motions.end(), whole.motions.begin(), whole.motions.end());
        if (i % kKept == 0) {
            step.scan = whole.scan;
            out.drive.steps.push_back(std::exchange(step, {}));
            out.stamps_s.push_back(run.stamps_s[i]);
        }
    }
    std::vector<double> kept = out.stamps_s;
    std::sort(kept.begin(), kept.end());
    const auto is_kept = [&](double stamp_s) {
        constexpr double kSame_s = 0.0005;
        const auto next = std::lower_bound(kept.begin(), kept.end(), stamp_s - kSame_s);
        return next != kept.end() && std::abs(*next - stamp_s) < kSame_s;
    };
    std::copy_if(run.relations.begin(), run.relations.end(), std::back_inserter(out.relations),
                 [&](const eval::Relation& r) { return is_kept(r.stamp1_s) && is_kept(r.stamp2_s); });
    return out;
}

double relation_error_m(const IntelRun& run, const std::vector<Pose2>& poses) {
    std::vector<TimedPose> trajectory;
    for (std::size_t i = 0; i < poses.size(); ++i) {
        trajectory.push_back({.stamp_s = run.stamps_s[i], .P_map_base = poses[i]});
    }
    return eval::relation_errors(trajectory, run.relations).translation_m.mean;
}

}  // namespace crspf::experiments
