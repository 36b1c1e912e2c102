#include <unistd.h>

#include <algorithm>
#include <cinttypes>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <system_error>
#include <utility>

#include "platform/files/input_error.hpp"
#include "platform/service/record_run.hpp"
#include "tools/crspf/commands.hpp"
#include "tools/crspf/stop_signals.hpp"

namespace crspf::cli {
namespace {

struct RecordOptions {
    std::string config;
    std::string out = ".";
    std::string prefix = "crspf";
    std::optional<double> duration_s;
    double file_mib = 256.0;
    double file_s = 600.0;
    double free_mib = 1024.0;
};

void print_status(const RecordStatus& status, bool whole) {
    for (const RecordStatus::Source& source : status.sources) {
        std::fprintf(stderr, "%s  %s: %" PRIu64 " records, %" PRIu64 " samples, %.1f/s; %s", whole ? "" : "\r\033[K",
                     source.name.c_str(), source.records, source.samples,
                     static_cast<double>(source.samples) / std::max(status.elapsed_s, 1e-3), source.state.c_str());
        if (whole) {
            for (const auto& [name, count] : source.counts) {
                if (count > 0) {
                    std::fprintf(stderr, ", %s %" PRIu64, name, count);
                }
            }
        }
        std::fputs("\n", stderr);
    }
    std::fprintf(stderr, "  %.0f s, %" PRIu64 " records in %" PRIu64 " files, now %s\n", status.elapsed_s,
                 status.recorder.written, status.recorder.files,
                 status.file.empty() ? "none" : status.file.filename().c_str());
    if (!status.problem.empty()) {
        std::fprintf(stderr, "  PAUSED, %" PRIu64 " records lost: %s\n", status.recorder.lost, status.problem.c_str());
    }
}

void run(const RecordOptions& options) {
    RecordJob job;
    job.config = load_config(options.config);
    job.recorder.directory = options.out;
    job.recorder.prefix = options.prefix;
    job.recorder.file_bytes_max = static_cast<std::uint64_t>(options.file_mib * 1048576.0);
    job.recorder.file_time_max = Duration::from_seconds(options.file_s);
    job.recorder.free_bytes_min = static_cast<std::uint64_t>(options.free_mib * 1048576.0);
    job.duration_s = options.duration_s;
    std::error_code error;
    std::filesystem::create_directories(options.out, error);
    if (error) {
        throw InputError(options.out + ": cannot make the directory: " + error.message() + "; give another --out");
    }
    const bool terminal = isatty(STDERR_FILENO) != 0;
    bool shown = false;
    if (terminal) {
        job.progress = [&](const RecordStatus& status) {
            if (std::exchange(shown, true)) {  // over what was shown a second ago
                std::fprintf(stderr, "\033[%zuA\033[J", status.sources.size() + (status.problem.empty() ? 1U : 2U));
            }
            print_status(status, false);
        };
    }
    std::fprintf(stderr, "recording into %s; Ctrl-C ends it\n", options.out.c_str());
    const RecordStatus status = run_record(job, stop_on_signals());
    print_status(status, true);
}

}  // namespace

void add_record(CLI::App& app) {
    const auto options = std::make_shared<RecordOptions>();
    CLI::App* const sub = app.add_subcommand("record", "Record all that the configured sensors say");
    sub->add_option("--config", options->config, "Configuration (TOML) with [source.NAME] tables")->required();
    sub->add_option("--out", options->out, "Directory for the files; made if need be")->capture_default_str();
    sub->add_option("--prefix", options->prefix, "Files are PREFIX-DATE-TIME.pcapng")->capture_default_str();
    sub->add_option("--duration", options->duration_s, "Stop after so many seconds")->check(CLI::Range(0.1, 1e7));
    sub->add_option("--file-size", options->file_mib, "A file ends before it is larger [MiB]")
        ->check(CLI::Range(1.0, 65536.0))
        ->capture_default_str();
    sub->add_option("--file-time", options->file_s, "A file ends after so many seconds")
        ->check(CLI::Range(1.0, 1e6))
        ->capture_default_str();
    sub->add_option("--keep-free", options->free_mib, "Pause while less than this is free on the disk [MiB]")
        ->check(CLI::Range(1.0, 1e6))
        ->capture_default_str();
    sub->footer(
        "One pcapng file holds every source, sent and received, and the configuration: `crspf replay` needs nothing\n"
        "else, and Wireshark opens it. A file that is cut short by a crash is readable up to its last record.\n"
        "\n"
        "Examples:\n"
        "  crspf record --config robot.toml --out runs\n"
        "  crspf record --config robot.toml --duration 60 && crspf replay crspf-*.pcapng --out out/run");
    sub->callback([options] { run(*options); });
}

}  // namespace crspf::cli
