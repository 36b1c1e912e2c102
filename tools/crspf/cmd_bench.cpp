#include <benchmark/benchmark.h>

#include <cstdio>
#include <map>
#include <memory>
#include <sstream>
#include <stdexcept>
#include <string>
#include <vector>

#include "platform/files/atomic_file.hpp"
#include "platform/files/input_error.hpp"
#include "tools/crspf/bench_cases.hpp"
#include "tools/crspf/commands.hpp"

namespace crspf::cli {

namespace {

struct BenchOptions {
    std::string filter = ".";
    std::string json;
};

/// Keeps the median of each case's repetitions, and everything as JSON.
class Report final : public benchmark::BenchmarkReporter {
 public:
    struct Median {
        double rate = 0.0;    ///< evaluations or scans per second
        double spread = 0.0;  ///< standard deviation over mean
    };

    Report() { json_reporter_.SetOutputStream(&json_); }

    bool ReportContext(const Context& context) override { return json_reporter_.ReportContext(context); }

    void ReportRuns(const std::vector<Run>& runs) override {
        json_reporter_.ReportRuns(runs);
        for (const Run& run : runs) {
            const std::string& name = run.run_name.function_name;
            if (run.error_occurred) {
                error_ = name + ": " + run.error_message;
            } else if (run.aggregate_name == "median") {
                medians_[name].rate = run.counters.at("items_per_second");
            } else if (run.aggregate_name == "cv") {
                medians_[name].spread = run.counters.at("items_per_second");
            }
        }
    }

    void Finalize() override { json_reporter_.Finalize(); }

    [[nodiscard]] const std::map<std::string, Median>& medians() const { return medians_; }
    [[nodiscard]] const std::string& error() const { return error_; }
    [[nodiscard]] std::string json() const { return json_.str(); }

 private:
    benchmark::JSONReporter json_reporter_;
    std::ostringstream json_;
    std::map<std::string, Median> medians_;
    std::string error_;
};

void print_cases(const Report& report) {
    std::printf("%-28s %12s %14s %8s\n", "case", "time", "per second", "spread");
    for (const auto& [name, median] : report.medians()) {
        std::printf("%-28s %9.3f us %14.0f %6.1f %%\n", name.c_str(), 1e6 / median.rate, median.rate,
                    100.0 * median.spread);
    }
}

/// Those of which both cases were run.
void print_ratios(const Report& report) {
    const auto& medians = report.medians();
    for (const BenchRatio& ratio : bench_ratios()) {
        const auto measured = medians.find(ratio.measured);
        const auto reference = medians.find(ratio.reference);
        if (measured != medians.end() && reference != medians.end()) {
            const double rates = measured->second.rate / reference->second.rate;
            std::printf("%s: %.2f x the %s\n", ratio.text, ratio.of == BenchRatio::Of::kRate ? rates : 1.0 / rates,
                        ratio.unit);
        }
    }
    for (const BenchRealTime& sensor : bench_real_times()) {
        const auto measured = medians.find(sensor.measured);
        if (measured != medians.end()) {
            std::printf("taken in / sent by a %s: %.0f x its %.0f per second\n", sensor.sensor,
                        measured->second.rate / sensor.per_s, sensor.per_s);
        }
    }
}

void run(const BenchOptions& options) {
    const auto json = options.json.empty() ? nullptr : std::make_unique<AtomicFile>(options.json);

    // Repetitions in random order, so that a processor that slows down meanwhile slows all cases alike.
    std::vector<std::string> settings{"crspf bench", "--benchmark_min_time=0.3", "--benchmark_repetitions=5",
                                      "--benchmark_enable_random_interleaving=true"};
    std::vector<char*> arguments;
    arguments.reserve(settings.size());
    for (std::string& setting : settings) {
        arguments.push_back(setting.data());
    }
    auto count = static_cast<int>(arguments.size());
    benchmark::Initialize(&count, arguments.data());
    register_bench_cases();

    Report report;
    if (benchmark::RunSpecifiedBenchmarks(&report, options.filter) == 0) {
        throw InputError("--filter " + options.filter +
                         ": no case has such a name; give a regular expression for a part of one, such as on_scan");
    }
    if (!report.error().empty()) {
        throw std::runtime_error(report.error());
    }
    print_cases(report);
    std::puts("");
    print_ratios(report);
    if (json != nullptr) {
        json->write(report.json());
        json->commit();
    }
}

}  // namespace

void add_bench(CLI::App& app) {
    auto options = std::make_shared<BenchOptions>();
    CLI::App* command = app.add_subcommand("bench", "Measure what matching, map update and whole scans cost here");
    command->footer(
        "Takes about half a minute. Prints for each case the processor time of one evaluation or scan (median of 5\n"
        "repetitions) and their spread (standard deviation over mean), then how the cases compare. The world is the\n"
        "office of `crspf sim`; build with -DCMAKE_BUILD_TYPE=Release and let nothing else run.\n"
        "\n"
        "Examples:\n"
        "  crspf bench\n"
        "  crspf bench --filter evaluation             the match field against formula (10) computed directly\n"
        "  crspf bench --filter on_scan --json scan.json");
    command->add_option("--filter", options->filter, "Only cases whose name matches")->type_name("REGEX");
    command->add_option("--json", options->json, "Also write all repetitions to FILE, in Google Benchmark's format")
        ->type_name("FILE");
    command->callback([options] { run(*options); });
}

}  // namespace crspf::cli
