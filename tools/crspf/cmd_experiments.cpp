#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

#include "platform/files/input_error.hpp"
#include "tools/crspf/commands.hpp"
#include "tools/experiments/report/machine.hpp"
#include "tools/experiments/report/report_files.hpp"
#include "tools/experiments/report/verdicts.hpp"
#include "tools/experiments/runner.hpp"

namespace crspf::cli {

namespace {

using experiments::Experiment;
using experiments::Section;

#ifdef __clang__
constexpr const char* kCompiler = __VERSION__;  // names itself
#else
constexpr const char* kCompiler = "g++ " __VERSION__;
#endif

struct ExperimentsOptions {
    std::vector<std::string> names;
    std::string out;
    std::string data;
    std::string maps;
    std::size_t seeds = 0;
    bool list = false;
};

/// A line of its own for each experiment; on a terminal it is rewritten while the experiment goes on.
class ExperimentLines {
 public:
    explicit ExperimentLines(std::size_t count) : count_(count) {}

    void begin(const Experiment& experiment) {
        ++number_;
        name_ = experiment.name;
        begin_ = Clock::now();
        shown_ = {};
        if (terminal_) {
            progress(0.0);
        } else {
            std::fprintf(stderr, "%s: %s\n", head().c_str(), experiment.title);
        }
    }

    void progress(double share) {
        constexpr std::chrono::milliseconds kApart{100};
        const Clock::time_point now = Clock::now();
        if (terminal_ && now - shown_ >= kApart) {
            shown_ = now;
            std::fprintf(stderr, "\r%s  %3.0f %%  %s\033[K", head().c_str(), 100.0 * std::clamp(share, 0.0, 1.0),
                         experiments::duration_text(std::chrono::duration<double>(now - begin_).count()).c_str());
        }
    }

    void end(const Section& section) const {
        std::string text = experiments::duration_text(section.seconds);
        if (!section.skipped.empty()) {
            text = "skipped: " + section.skipped;
        } else if (!section.failure.empty()) {
            text = "failed: " + section.failure;
        }
        std::fprintf(stderr, "%s%s  %s%s\n", terminal_ ? "\r" : "", head().c_str(), text.c_str(),
                     terminal_ ? "\033[K" : "");
    }

 private:
    using Clock = std::chrono::steady_clock;

    [[nodiscard]] std::string head() const { return fmt::format("{:2}/{} {:<9}", number_, count_, name_); }

    bool terminal_ = ::isatty(STDERR_FILENO) == 1;
    std::size_t count_;
    std::size_t number_ = 0;
    std::string name_;
    Clock::time_point begin_;
    Clock::time_point shown_;
};

class ScratchDirectory {
 public:
    ScratchDirectory() {
        std::string name = (std::filesystem::temp_directory_path() / "crspf-experiments-XXXXXX").string();
        if (::mkdtemp(name.data()) == nullptr) {
            throw InputError(name + ": cannot be created; set TMPDIR to a directory that can be written to");
        }
        path_ = name;
    }
    ScratchDirectory(const ScratchDirectory&) = delete;
    ScratchDirectory& operator=(const ScratchDirectory&) = delete;
    ~ScratchDirectory() {
        std::error_code ignored;
        std::filesystem::remove_all(path_, ignored);
    }
    [[nodiscard]] const std::filesystem::path& path() const { return path_; }

 private:
    std::filesystem::path path_;
};

std::string quoted(const std::string& argument) {
    constexpr const char* kPlain = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_-./:=+,@%";
    return !argument.empty() && argument.find_first_not_of(kPlain) == std::string::npos ? argument
                                                                                        : "'" + argument + "'";
}

// As a shell takes them.
std::string text_of(const ExperimentsOptions& options) {
    std::string text = " --out " + quoted(options.out);
    if (!options.data.empty()) {
        text += " --data " + quoted(options.data);
    }
    if (!options.maps.empty()) {
        text += " --maps " + quoted(options.maps);
    }
    if (options.seeds != 0) {
        text += " --seeds " + std::to_string(options.seeds);
    }
    return text;
}

std::filesystem::path existing(const std::string& directory, const char* option) {
    if (!directory.empty() && !std::filesystem::is_directory(directory)) {
        throw InputError(directory + ": is no directory; give another " + option + ", or none");
    }
    return directory;
}

experiments::Context context_of(const ExperimentsOptions& options, const std::filesystem::path& scratch) {
    experiments::Context context{.data = existing(options.data, "--data"),
                                 .maps = existing(options.maps, "--maps"),
                                 .scratch = scratch,
                                 .seeds = options.seeds,
                                 .progress = {}};
    if (const char* data = std::getenv("CRSPF_DATA"); context.data.empty() && data != nullptr) {
        context.data = data;
    }
    if (context.maps.empty() && !context.data.empty()) {
        context.maps = context.data / "maps";
    }
    return context;
}

void list(std::span<const Experiment> all) {
    for (const Experiment& experiment : all) {
        std::printf("%-9s %s (%s)\n", experiment.name, experiment.title, experiment.source);
    }
}

void run(const ExperimentsOptions& options, std::span<const Experiment> all) {
    if (options.list) {
        list(all);
        return;
    }
    if (options.out.empty()) {
        throw CLI::RequiredError("--out");
    }
    const std::vector<Experiment> some = experiments::chosen(all, options.names);
    const ScratchDirectory scratch;
    const experiments::Context context = context_of(options, scratch.path());
    experiments::prepare_directory(options.out);

    experiments::Report report{.command = "crspf experiments",
                               .version = CRSPF_VERSION,
                               .compiler = kCompiler,
                               .machine = experiments::this_machine(),
                               .date = experiments::this_date(),
                               .sections = {}};
    for (const std::string& name : options.names) {
        report.command += " " + name;
    }
    report.command += text_of(options);

    ExperimentLines lines(some.size());
    experiments::Outcome outcome =
        experiments::run_all(some, context, text_of(options),
                             {.begins = [&](const Experiment& experiment) { lines.begin(experiment); },
                              .progress = [&](double share) { lines.progress(share); },
                              .ends = [&](const Section& section) { lines.end(section); }});
    report.sections = std::move(outcome.sections);
    experiments::write_report(report, options.out);
    std::printf(
        "%s\nwritten to %s: report.html, report.json, headlines.md, claims.md and the figures that documents show\n",
        experiments::text_of(experiments::tally_of(report.sections)).c_str(), options.out.c_str());
    constexpr const char* kSeeReport = "an experiment failed; report.html says which and why";
    if (outcome.internal_error) {
        throw std::runtime_error(kSeeReport);
    }
    if (outcome.failed) {
        throw InputError(kSeeReport);
    }
}

}  // namespace

void add_experiments(CLI::App& app, std::span<const Experiment> all) {
    constexpr std::uint64_t kSeedsMax = 1000;
    auto options = std::make_shared<ExperimentsOptions>();
    CLI::App* command = app.add_subcommand(
        "experiments", "Repeat the paper's experiments: what it claims beside what is measured here");
    command->footer(
        "Writes DIR/report.html (one file, opens offline in any browser), report.json, headlines.md, claims.md, and "
        "the\n"
        "figures that documents show as .svg and .png. All experiments take some 20 minutes on two quiet cores; let\n"
        "nothing else run, since some measure load. Equal seeds give equal figures, but for times and loads.\n"
        "An experiment whose recording or map is absent is skipped and says so. One that fails does not keep the "
        "others\n"
        "from running; the exit status is then 1. What a verdict means, and the JSON: docs/experiments.md.\n"
        "\n"
        "Examples:\n"
        "  crspf experiments --list\n"
        "  crspf experiments --out report\n"
        "  crspf experiments table1 corridor --out report --seeds 2      quickly\n"
        "  crspf experiments logs --out report --data recordings         with real logs");
    command->add_option("NAME", options->names, "Only these experiments; their names by --list")->type_name("");
    command->add_option("--out", options->out, "Directory of the report; created where it is absent")->type_name("DIR");
    command->add_option("--data", options->data, "Recordings, such as DIR/carmen/intel.clf.xz [$CRSPF_DATA, else none]")
        ->type_name("DIR");
    command->add_option("--maps", options->maps, "Maps, such as DIR/1r5.yaml [maps below --data]")->type_name("DIR");
    command->add_option("--seeds", options->seeds, "Runs of what is random [as many as each experiment has by itself]")
        ->type_name("N")
        ->check(CLI::Range(std::uint64_t{1}, kSeedsMax));
    command->add_flag("--list", options->list, "Only tell the names of the experiments");
    command->callback([options, all] { run(*options, all); });
}

}  // namespace crspf::cli
