#include "tools/crspf/run_options.hpp"

#include <unistd.h>

#include <cstdio>

#include "core/base/trig.hpp"

namespace crspf::cli {

void add_run_options(CLI::App& command, RunOptions& options) {
    command
        .add_option("INPUT", options.inputs,
                    "Plain or compressed (.xz .gz ...): logs that are parts of one run, in order; or recordings of "
                    "sensors (pcapng, pcap, candump), played together on one time line")
        ->required();
    command.add_option("--config", options.config,
                       "Configuration (TOML); default: that of the recording, else one for an indoor robot");
    command.add_option("--localize", options.localize, "Localise on this map (map_server YAML) and leave it as it is");
    command
        .add_option("--initial-pose", options.initial_pose,
                    "Pose of base_link in the map at the start: x [m] y [m] heading [deg]")
        ->expected(3);
}

ReplayJob job_of(const RunOptions& options) {
    ReplayJob job;
    job.logs.assign(options.inputs.begin(), options.inputs.end());
    if (!options.config.empty()) {
        job.config = load_config(options.config);
    }
    if (!options.localize.empty()) {
        job.localize = options.localize;
    }
    if (!options.initial_pose.empty()) {
        job.initial_pose = Pose2{.x_m = options.initial_pose[0],
                                 .y_m = options.initial_pose[1],
                                 .theta_rad = wrap_angle(radians(options.initial_pose[2]))};
    }
    return job;
}

ProgressBar::ProgressBar() : terminal_(isatty(STDERR_FILENO) != 0) {}

ProgressBar::~ProgressBar() {
    if (terminal_) {
        std::fprintf(stderr, "\r\033[K");
    }
}

void ProgressBar::show(double share, std::uint64_t scans) const {
    if (!terminal_) {
        return;
    }
    constexpr int kWidth = 40;
    const int full = static_cast<int>(share * kWidth);
    std::fprintf(stderr, "\r[%-*.*s] %3.0f %%  %llu scans", kWidth, full, "########################################",
                 100.0 * share, static_cast<unsigned long long>(scans));
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

void warn_of_map(std::uint64_t refused) {
    if (refused > 0) {
        std::fprintf(stderr,
                     "crspf: warning: the map is full or its extent was left: %llu writes refused; SLAM went on. Raise "
                     "[map] resolution_m or the bounds in config/capacities.hpp\n",
                     static_cast<unsigned long long>(refused));
    }
}

void print_sources(const std::vector<SourceReport>& sources) {
    for (const SourceReport& source : sources) {
        std::puts(text_of(source).c_str());
    }
}

}  // namespace crspf::cli
