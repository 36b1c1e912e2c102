// A simulated robot down to the bytes on its lines, and the replay of what was captured.
#pragma once

#include <string>

#include "tools/crspf/replay.hpp"
#include "tools/crspf/sim_params.hpp"
#include "tools/eval/ate.hpp"
#include "tools/experiments/report/report.hpp"

namespace crspf::experiments {

struct CapturedRun {
    eval::AteReport error;  ///< with the first poses laid on each other
    ReplayOutcome outcome;
    double driven_m = 0.0;
    double simulated_s = 0.0;
};

/// Simulates into `options.out`, which is made, and replays the capture with the configuration that it holds.
[[nodiscard]] CapturedRun run_captured(cli::SimOptions options);

[[nodiscard]] Picture map_picture(const CapturedRun& run, std::string caption);

/// The head of a table of such runs, and a row of it.
[[nodiscard]] Table captured_table(std::string caption);
void add_row(Table& table, std::string run, const CapturedRun& captured);
[[nodiscard]] nlohmann::ordered_json to_json(const CapturedRun& run);

}  // namespace crspf::experiments
