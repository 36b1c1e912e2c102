#include <cstdio>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>

#include "tools/crspf/commands.hpp"
#include "tools/crspf/odometry_replay.hpp"
#include "tools/crspf/replay.hpp"
#include "tools/crspf/run_options.hpp"

namespace crspf::cli {
namespace {

struct ReplayOptions {
    RunOptions run;
    std::string out = "out";
    std::string kernel = "fastest";
    double rate = 0.0;
    bool odometry_only = false;
};

/// The outcome of `play`, whose progress a terminal shows.
template <class Play>
auto with_progress(ReplayJob& job, const Play& play) {
    const ProgressBar bar;
    job.progress = [&bar](double share, std::uint64_t scans) { bar.show(share, scans); };
    auto outcome = play(job);
    job.progress = nullptr;
    return outcome;
}

void play_odometry(ReplayJob& job, const std::string& directory) {
    const OdometryOutcome outcome = with_progress(job, run_odometry);
    warn(outcome.log);
    print_sources(outcome.sources);
    const nlohmann::json report = nlohmann::json::parse(write_odometry(outcome, job, directory));
    std::printf("%zu samples of the odometer, %llu of them blind; %.2f ms of processor time each\n",
                outcome.trajectory.size(), static_cast<unsigned long long>(outcome.blind),
                report["cpu_ms_per_sample_everything"].get<double>());
    std::printf("digest %s\nwritten to %s: trajectory.tum, report.json%s\n", outcome.digest.c_str(), directory.c_str(),
                outcome.camera_path.empty() ? "" : ", poses.txt");
}

void run(const ReplayOptions& options) {
    ReplayJob job = job_of(options.run);
    job.rate = options.rate;
    job.kernel = options.kernel == "portable" ? Kernel::kPortable : Kernel::kFastest;
    if (options.odometry_only) {
        play_odometry(job, options.out);
        return;
    }
    const auto outcome = with_progress(job, run_replay);
    warn(outcome.log);
    warn_of_map(outcome.pipeline->map().refused());
    print_sources(outcome.sources);
    const nlohmann::json report = nlohmann::json::parse(write_replay(outcome, job, options.out));
    const nlohmann::json& ms = report["time_per_scan_ms"];
    const nlohmann::json& pipeline = report["pipeline"];
    std::printf("%llu scans, %llu key frames, %llu drawn, %llu not believed, %llu with a degenerate direction\n",
                report["scans"].get<unsigned long long>(), pipeline["key_frames"].get<unsigned long long>(),
                pipeline["drawn"].get<unsigned long long>(), pipeline["not_believed"].get<unsigned long long>(),
                pipeline["degenerate"].get<unsigned long long>());
    std::printf("match value M: median %.0f, lowest percent below %.0f; %.0f evaluations a scan\n",
                report["match_value_M"]["p50"].get<double>(), report["match_value_M"]["p01"].get<double>(),
                report["evaluations_per_scan"]["mean"].get<double>());
    std::printf("core: mean %.3f ms a scan, p99 %.3f, max %.3f; everything with reading: %.3f; peak memory %.1f MiB\n",
                ms["mean"].get<double>(), ms["p99"].get<double>(), ms["max"].get<double>(),
                report["cpu_ms_per_scan_everything"].get<double>(), report["peak_rss_mib"].get<double>());
    std::printf("digest %s\n", outcome.digest.c_str());
    std::printf("written to %s: trajectory.tum, map.pgm, map.yaml, map.png (look at this one), report.json\n",
                options.out.c_str());
}

}  // namespace

void add_replay(CLI::App& app) {
    auto* command = app.add_subcommand("replay", "Recorded runs in; trajectory, map and report out");
    const auto options = std::make_shared<ReplayOptions>();
    add_run_options(*command, options->run);
    command->add_option("--rate", options->rate, "Pace: 1 as it was recorded, 2 twice as fast; 0 as fast as possible")
        ->check(CLI::Range(0.0, 1000.0))
        ->capture_default_str();
    command->add_option("--out", options->out, "Directory to write to; made if need be")->capture_default_str();
    command->add_flag("--odometry-only", options->odometry_only,
                      "Only what the odometer makes of it: trajectory.tum, and poses.txt of a stereo camera");
    command
        ->add_option("--kernel", options->kernel,
                     "Match kernel: the fastest that the processor has, or the portable one; the poses are the same")
        ->check(CLI::IsMember({"fastest", "portable"}))
        ->capture_default_str();
    command->footer(
        "Reads CARMEN logs (FLASER, ODOM, ROBOTLASER1, PARAM) and URG-04LX .dat logs; and what the sensors sent,\n"
        "recorded by `crspf record`, tcpdump or candump: there the configuration says which driver understands "
        "what. A folder of\n"
        "pairs of pictures as KITTI's (image_0/, image_1/, calib.txt, times.txt) is the recording of a stereo "
        "camera.\n\n"
        "Examples:\n"
        "  crspf replay intel.clf.xz --out out/intel\n"
        "  crspf replay run.pcapng --out out/run\n"
        "  crspf replay lidar.pcap base.candump.log --config robot.toml --out out/run\n"
        "  crspf replay kitti/ --odometry-only --out out/kitti\n"
        "  crspf replay pictures/ lidar.pcapng --config robot.toml --out out/run\n"
        "  crspf replay exp1.dat --config config/examples/urg04lx.toml --out out/exp1\n"
        "  crspf replay second.clf --localize out/intel/map.yaml --initial-pose 0 0 0 --out out/second");
    command->callback([options] { run(*options); });
}

}  // namespace crspf::cli
