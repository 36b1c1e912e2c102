// crspf eval match.
#include <cstdio>
#include <filesystem>
#include <memory>
#include <vector>

#include "config/config.hpp"
#include "platform/files/trajectory.hpp"
#include "tools/crspf/eval_commands.hpp"
#include "tools/crspf/eval_output.hpp"
#include "tools/eval/match_values.hpp"

namespace crspf::cli {
namespace {

struct MatchCommand {
    std::filesystem::path trajectory;
    std::vector<std::filesystem::path> logs;
    std::filesystem::path config;
    bool json = false;

    void run() const {
        const auto rows =
            eval::match_values(logs, config.empty() ? Config{} : load_config(config), read_tum(trajectory));
        if (json) {
            Json out = Json::array();
            for (const eval::MatchValues& row : rows) {
                out.push_back({{"distance_m", row.distance_m},
                               {"turn_deg", row.turn_deg},
                               {"scans", row.scans},
                               {"p01", row.p01},
                               {"p50", row.median},
                               {"p99", row.p99}});
            }
            print_json(out);
            return;
        }
        std::printf("%-24s %8s %8s %8s %8s\n", "match value m", "scans", "1 %", "median", "99 %");
        for (const eval::MatchValues& row : rows) {
            std::printf("%5.2f m %4.1f deg beside    %8zu %8.0f %8.0f %8.0f\n", row.distance_m, row.turn_deg, row.scans,
                        row.p01, row.median, row.p99);
        }
    }
};

}  // namespace

void add_match(CLI::App& eval) {
    const auto command = std::make_shared<MatchCommand>();
    CLI::App* const sub = eval.add_subcommand(
        "match", "Whether the match value tells a run's poses from poses beside them: where thresholds belong");
    sub->add_option("TRAJECTORY", command->trajectory, "trajectory in TUM format, one pose a scan of the logs")
        ->required();
    sub->add_option("LOG", command->logs, "the logs it was made from, in order; plain or compressed")->required();
    sub->add_option("--config", command->config, "configuration (TOML) of the replay");
    sub->add_flag("--json", command->json, "print JSON");
    sub->footer(
        "Each scan is matched with the map that the scans before it have made: at its pose of the trajectory, and at\n"
        "poses moved to a random side and turned. Thresholds of [analyser] belong between the first row's lowest\n"
        "percent and the medians of the others.\n\n"
        "Example:\n  crspf eval match out/intel/trajectory.tum intel.clf.xz");
    sub->callback([command] {
        command->run();
        check_output();
    });
}

}  // namespace crspf::cli
