#include <unistd.h>

#include <cstdio>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "core/base/trig.hpp"
#include "platform/files/input_error.hpp"
#include "tools/crspf/commands.hpp"
#include "tools/crspf/odometry_replay.hpp"
#include "tools/crspf/replay.hpp"

namespace crspf::cli {
namespace {

struct ReplayOptions {
    std::vector<std::string> inputs;
    std::string config;
    std::string out = "out";
    std::string localize;
    std::vector<double> initial_pose;
    std::string kernel = "fastest";
    double rate = 0.0;
    bool odometry_only = false;
};

void show_progress(double share, std::uint64_t scans) {
    constexpr int kWidth = 40;
    const int full = static_cast<int>(share * kWidth);
    std::fprintf(stderr, "\r[%-*.*s] %3.0f %%  %llu scans", kWidth, full, "########################################",
                 100.0 * share, static_cast<unsigned long long>(scans));
}

void clear_progress() {
    std::fprintf(stderr, "\r\033[K");
}

/// The outcome of `play`, whose progress a terminal shows.
template <class Play>
auto with_progress(ReplayJob& job, const Play& play) {
    const bool terminal = isatty(STDERR_FILENO) != 0;
    if (terminal) {
        job.progress = show_progress;
    }
    try {
        auto outcome = play(job);
        if (terminal) {
            clear_progress();
        }
        return outcome;
    } catch (const InputError&) {
        if (terminal) {
            clear_progress();
        }
        throw;
    }
}

void print(const std::vector<SourceReport>& sources) {
    for (const SourceReport& source : sources) {
        std::puts(text_of(source).c_str());
    }
}

void warn(const LogCounts& log) {
    if (log.damaged_lines > 0) {
        std::fprintf(stderr, "crspf: warning: %llu damaged lines or records, the first: %s\n",
                     static_cast<unsigned long long>(log.damaged_lines), log.first_damage.c_str());
    }
    if (log.stamp_jumps > 0) {
        std::fprintf(stderr,
                     "crspf: warning: %llu stamps run back or leap; played in file order on a repaired time line, the "
                     "trajectory keeps the recorded stamps\n",
                     static_cast<unsigned long long>(log.stamp_jumps));
    }
}

void warn_of_map(const ReplayOutcome& outcome) {
    if (outcome.pipeline->map().refused() > 0) {
        std::fprintf(stderr,
                     "crspf: warning: the map is full or its extent was left: %llu writes refused; SLAM went on. Raise "
                     "[map] resolution_m or the bounds in config/capacities.hpp\n",
                     static_cast<unsigned long long>(outcome.pipeline->map().refused()));
    }
}

void play_odometry(ReplayJob& job, const std::string& directory) {
    const OdometryOutcome outcome = with_progress(job, run_odometry);
    warn(outcome.log);
    print(outcome.sources);
    const nlohmann::json report = nlohmann::json::parse(write_odometry(outcome, job, directory));
    std::printf("%zu samples of the odometer, %llu of them blind; %.2f ms of processor time each\n",
                outcome.trajectory.size(), static_cast<unsigned long long>(outcome.blind),
                report["cpu_ms_per_sample_everything"].get<double>());
    std::printf("digest %s\nwritten to %s: trajectory.tum, report.json%s\n", outcome.digest.c_str(), directory.c_str(),
                outcome.camera_path.empty() ? "" : ", poses.txt");
}

void run(const ReplayOptions& options) {
    ReplayJob job;
    job.logs.assign(options.inputs.begin(), options.inputs.end());
    if (!options.config.empty()) {
        job.config = load_config(options.config);
    }
    job.rate = options.rate;
    job.kernel = options.kernel == "portable" ? Kernel::kPortable : Kernel::kFastest;
    if (!options.localize.empty()) {
        job.localize = options.localize;
    }
    if (!options.initial_pose.empty()) {
        job.initial_pose = Pose2{.x_m = options.initial_pose[0],
                                 .y_m = options.initial_pose[1],
                                 .theta_rad = wrap_angle(radians(options.initial_pose[2]))};
    }
    if (options.odometry_only) {
        play_odometry(job, options.out);
        return;
    }
    const auto outcome = with_progress(job, run_replay);
    warn(outcome.log);
    warn_of_map(outcome);
    print(outcome.sources);
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
    command
        ->add_option("INPUT", options->inputs,
                     "Plain or compressed (.xz .gz ...): logs that are parts of one run, in order; or recordings of "
                     "sensors (pcapng, pcap, candump), played together on one time line")
        ->required();
    command->add_option("--config", options->config,
                        "Configuration (TOML); default: that of the recording, else one for an indoor robot");
    command->add_option("--rate", options->rate, "Pace: 1 as it was recorded, 2 twice as fast; 0 as fast as possible")
        ->check(CLI::Range(0.0, 1000.0))
        ->capture_default_str();
    command->add_option("--out", options->out, "Directory to write to; made if need be")->capture_default_str();
    command->add_option("--localize", options->localize,
                        "Localise on this map (map_server YAML) and leave it as it is");
    command
        ->add_option("--initial-pose", options->initial_pose,
                     "Pose of base_link in the map at the start: x [m] y [m] heading [deg]")
        ->expected(3);
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
