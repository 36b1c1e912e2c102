// crspf eval relocalization.
#include <cstdio>
#include <filesystem>
#include <memory>
#include <vector>

#include "config/config.hpp"
#include "platform/files/grid_map.hpp"
#include "platform/files/trajectory.hpp"
#include "tools/crspf/eval_commands.hpp"
#include "tools/crspf/eval_output.hpp"
#include "tools/eval/relocalization.hpp"

namespace crspf::cli {
namespace {

struct RelocalizationCommand {
    std::filesystem::path trajectory;
    std::vector<std::filesystem::path> logs;
    std::filesystem::path map;
    std::filesystem::path config;
    eval::RelocalizationOptions options;
    bool json = false;

    void run() const {
        const eval::RelocalizationReport report = eval::relocalize(
            read_grid_map(map), logs, config.empty() ? Config{} : load_config(config), read_tum(trajectory), options);
        if (json) {
            print_json(as_json(report));
        } else {
            print(report);
        }
    }

    static Json as_json(const eval::RelocalizationReport& report) {
        return {{"scans", report.scans},
                {"right", report.right},
                {"wrong", report.wrong},
                {"ambiguous", report.ambiguous},
                {"ambiguous_right", report.ambiguous_right},
                {"not_found", report.not_found},
                {"no_answer", report.no_answer},
                {"share", to_json(report.share)},
                {"runner_up", to_json(report.runner_up)},
                {"wrong_share", to_json(report.wrong_share)},
                {"wrong_at_truth", to_json(report.wrong_at_truth)},
                {"position_m", to_json(report.position_m)},
                {"heading_deg", to_json(report.heading_deg)},
                {"time_s", to_json(report.time_s)},
                {"load_s", report.load_s},
                {"memory_bytes", report.memory_bytes}};
    }

    void print(const eval::RelocalizationReport& report) const {
        std::printf("%zu scans: right within %g m and %g deg\n", report.scans, options.right_m, options.right_deg);
        const auto line = [&report](const char* name, std::size_t scans) {
            std::printf("%-28s %6zu %7.1f %%\n", name, scans,
                        100.0 * static_cast<double>(scans) / static_cast<double>(report.scans));
        };
        line("found, right", report.right);
        line("found, wrong", report.wrong);
        line("ambiguous", report.ambiguous);
        line("  the better one right", report.ambiguous_right);
        line("not found", report.not_found);
        line("no answer", report.no_answer);
        print_heading();
        print_summary("scan explained by the best", report.share);
        print_summary("by the best other place", report.runner_up);
        if (report.wrong > 0) {
            print_summary("wrong: by the place found", report.wrong_share);
            print_summary("wrong: by the truth", report.wrong_at_truth);
        }
        print_summary("position, right [m]", report.position_m);
        print_summary("heading, right [deg]", report.heading_deg);
        print_summary("processor time [s]", report.time_s);
        std::printf("map taken in %.3f s; %.2f MiB beside it\n", report.load_s,
                    static_cast<double>(report.memory_bytes) / (1024.0 * 1024.0));
    }
};

}  // namespace

void add_relocalization(CLI::App& eval) {
    const auto command = std::make_shared<RelocalizationCommand>();
    CLI::App* const sub = eval.add_subcommand(
        "relocalization", "Whether single scans of a run are found anywhere in a map, without a guess of the pose");
    sub->add_option("TRAJECTORY", command->trajectory,
                    "the truth, in the map's frame: TUM format, one pose a scan of the logs")
        ->required();
    sub->add_option("LOG", command->logs, "the logs of the run, in order; plain or compressed")->required();
    sub->add_option("--map", command->map, "YAML of the map (map_server format)")->required();
    sub->add_option("--config", command->config, "configuration (TOML) of the replay: mounting and range of the lidar");
    sub->add_option("--scans", command->options.scans, "random scans to try")
        ->check(CLI::Range(1, 1'000'000))
        ->capture_default_str();
    sub->add_option("--seed", command->options.seed, "the same seed tries the same scans")->capture_default_str();
    sub->add_flag("--json", command->json, "print JSON");
    sub->footer(
        "A scan counts as found where one place explains it better than any other beyond doubt. Where two places\n"
        "explain it alike it is ambiguous: as it should be in places that look alike.\n\n"
        "Example:\n"
        "  crspf eval relocalization out/intel/trajectory.tum intel.clf.xz --map out/intel/map.yaml");
    sub->callback([command] {
        command->run();
        check_output();
    });
}

}  // namespace crspf::cli
