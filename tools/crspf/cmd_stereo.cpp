#include <unistd.h>

#include <cinttypes>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <system_error>

#include "platform/files/input_error.hpp"
#include "platform/service/stereo_run.hpp"
#include "tools/crspf/commands.hpp"
#include "tools/crspf/stop_signals.hpp"

namespace crspf::cli {
namespace {

struct StereoOptions {
    std::string config;
    std::string record;
    std::optional<double> duration_s;
    double free_mib = 1024.0;
};

void print_status(const StereoStatus& status) {
    std::fprintf(stderr, "%.0f s, %s, %.1f ms a pair, %" PRIu64 " motions sent", status.elapsed_s, status.sight.c_str(),
                 status.work_ms, status.sent.sent);
    for (const auto& [name, count] : status.counts) {
        if (count > 0) {
            std::fprintf(stderr, ", %s %" PRIu64, name, count);
        }
    }
    if (status.recorder.written > 0) {
        std::fprintf(stderr, "; %" PRIu64 " pairs in %s", status.recorder.written, status.file.filename().c_str());
    }
    if (!status.problem.empty()) {
        std::fprintf(stderr, "; PROBLEM: %s", status.problem.c_str());
    }
}

void run(const StereoOptions& options) {
    StereoJob job;
    job.config = load_config(options.config);
    job.duration_s = options.duration_s;
    if (!options.record.empty()) {
        std::error_code error;
        std::filesystem::create_directories(options.record, error);
        if (error) {
            throw InputError(options.record + ": cannot make the directory: " + error.message() +
                             "; give another --record");
        }
        RecorderParams params;
        params.directory = options.record;
        params.prefix = "stereo";
        params.free_bytes_min = static_cast<std::uint64_t>(options.free_mib * 1048576.0);
        job.record = params;
    }
    // A terminal sees each second; a journal the changes only.
    const bool terminal = isatty(STDERR_FILENO) != 0;
    std::string said = "sees";
    job.progress = [&](const StereoStatus& status) {
        if (terminal) {
            std::fputs("\r\033[K", stderr);
            print_status(status);
        } else if (const std::string now = status.problem.empty() ? status.sight : status.problem; now != said) {
            said = now;
            print_status(status);
            std::fputs("\n", stderr);
        }
    };
    const StereoStatus status = run_stereo(job, stop_on_signals());
    if (terminal) {
        std::fputs("\r\033[K", stderr);
    }
    print_status(status);
    std::fputs("\n", stderr);
}

}  // namespace

void add_stereo(CLI::App& app) {
    const auto options = std::make_shared<StereoOptions>();
    CLI::App* const sub = app.add_subcommand("stereo", "Visual odometry: pictures of a stereo camera to crspfd");
    sub->add_option("--config", options->config, "Configuration (TOML) with [stereo] and a source of driver motion")
        ->required();
    sub->add_option("--record", options->record, "Directory for recordings of the pictures; made if need be");
    sub->add_option("--duration", options->duration_s, "Stop after so many seconds")->check(CLI::Range(0.1, 1e7));
    sub->add_option("--keep-free", options->free_mib, "Pause recording while less than this is free on the disk [MiB]")
        ->check(CLI::Range(1.0, 1e6))
        ->capture_default_str();
    sub->footer(
        "Runs beside crspfd, with the same configuration, as an ordinary process: crspf-stereo.service. crspfd hears "
        "the\n"
        "motion at the port of its source with driver = \"motion\". Whatever the pictures do not show is told as "
        "such.\n"
        "\n"
        "Examples:\n"
        "  crspf stereo --config /etc/crspf/crspfd.toml\n"
        "  crspf stereo --config robot.toml --record pictures --duration 60\n"
        "  crspf replay pictures/stereo-*.pcapng --odometry-only");
    sub->callback([options] { run(*options); });
}

}  // namespace crspf::cli
