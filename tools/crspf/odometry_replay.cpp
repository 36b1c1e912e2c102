#include "tools/crspf/odometry_replay.hpp"

#include <algorithm>
#include <ctime>
#include <memory>
#include <nlohmann/json.hpp>
#include <system_error>
#include <utility>

#include "platform/files/atomic_file.hpp"
#include "platform/files/input_error.hpp"
#include "platform/service/open_run.hpp"
#include "tools/crspf/pose_digest.hpp"
#include "tools/crspf/run_report.hpp"

namespace crspf {

namespace {

double processor_time_s() {
    timespec t{};
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
    return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
}

/// False where the event is no odometer's.
bool take(const LogEvent& event, Odometry& odometry) {
    switch (event.kind) {
        case LogEvent::Kind::kMotion: odometry.add(event.motion); return true;
        case LogEvent::Kind::kDifferential: odometry.add(event.differential); return true;
        case LogEvent::Kind::kAckermann: odometry.add(event.ackermann); return true;
        case LogEvent::Kind::kImu: odometry.add(event.imu); return true;
        case LogEvent::Kind::kScan:
        case LogEvent::Kind::kCloud:
        case LogEvent::Kind::kPlace: break;
    }
    return false;
}

}  // namespace

OdometryOutcome run_odometry(const ReplayJob& job) {
    OdometryOutcome out;
    const double began_s = processor_time_s();
    Run run = open_run(job.logs, job.config);
    const auto odometry = std::make_unique<Odometry>(run.config.slam.odometry);
    const auto event = std::make_unique<LogEvent>();
    Duration origin;  // each log's time line starts at 0: they are laid end to end
    Stamp newest;
    for (std::size_t i = 0; i < run.parts.size(); ++i) {
        const std::unique_ptr<LogReader> log = std::move(run.parts[i]);
        while (log->next(*event)) {
            shift(*event, origin);
            newest = std::max(newest, stamp_of(*event));
            if (!take(*event, *odometry)) {
                continue;
            }
            if (event->kind == LogEvent::Kind::kMotion && event->motion.blind) {
                ++out.blind;
            }
            out.trajectory.push_back({.stamp_s = event->recorded_stamp_s, .P_map_base = odometry->pose()});
            constexpr std::size_t kSamplesPerReport = 16;
            if (job.progress && out.trajectory.size() % kSamplesPerReport == 0) {
                job.progress((static_cast<double>(i) + log->progress()) / static_cast<double>(run.parts.size()),
                             out.trajectory.size());
            }
        }
        add(out.log, log->counts());
        for (SourceReport& source : log->sources()) {
            out.sources.push_back(std::move(source));
        }
        const std::vector<KittiPose> path = log->take_camera_path();
        out.camera_path.insert(out.camera_path.end(), path.begin(), path.end());
        origin = newest - Stamp{};
    }
    if (out.trajectory.empty()) {
        std::string what = job.logs.back().string() + ": no sample of an odometer in it";
        for (const SourceReport& source : out.sources) {
            what += "; " + text_of(source);
        }
        throw InputError(what);
    }
    out.odometry = odometry->counters();
    out.digest = digest_of(out.trajectory);
    out.cpu_s = processor_time_s() - began_s;
    return out;
}

std::string write_odometry(const OdometryOutcome& outcome, const ReplayJob& job,
                           const std::filesystem::path& directory) {
    std::error_code error;
    std::filesystem::create_directories(directory, error);
    if (error) {
        throw InputError(directory.string() + ": cannot make the directory: " + error.message());
    }
    write_tum(outcome.trajectory, directory / "trajectory.tum");
    if (!outcome.camera_path.empty()) {
        write_kitti_poses(outcome.camera_path, directory / "poses.txt");
    }
    nlohmann::ordered_json report;
    for (const std::filesystem::path& log : job.logs) {
        report["logs"].push_back(log.string());
    }
    report["samples"] = outcome.trajectory.size();
    report["blind"] = outcome.blind;
    report["digest"] = outcome.digest;
    report["cpu_ms_per_sample_everything"] = 1e3 * outcome.cpu_s / static_cast<double>(outcome.trajectory.size());
    report["odometry"] = to_json(outcome.odometry);
    report["log"] = to_json(outcome.log);
    if (!outcome.sources.empty()) {
        report["sources"] = to_json(outcome.sources);
    }
    std::string text = report.dump(2) + "\n";
    AtomicFile file(directory / "report.json");
    file.write(text);
    file.commit();
    return text;
}

}  // namespace crspf
