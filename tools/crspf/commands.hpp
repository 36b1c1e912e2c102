// The sub-commands of `crspf`: each file adds its own to the command line and runs it.
#pragma once

#include <CLI/CLI.hpp>
#include <span>

namespace crspf::experiments {
struct Experiment;
}

namespace crspf::cli {

/// Each adds one sub-command. Its callback does the work, throws InputError for what the user can mend, and leaves the
/// exit status to main().
void add_replay(CLI::App& app);
void add_sim(CLI::App& app);
void add_eval(CLI::App& app);
void add_calibrate(CLI::App& app);
void add_bench(CLI::App& app);
void add_config(CLI::App& app);
void add_ctl(CLI::App& app);
void add_top(CLI::App& app);
void add_inspect(CLI::App& app);
void add_record(CLI::App& app);
void add_stereo(CLI::App& app);
void add_doctor(CLI::App& app);
void add_export(CLI::App& app);
void add_view(CLI::App& app);
void add_mqtt(CLI::App& app);

/// Tests give it others than the paper's.
void add_experiments(CLI::App& app, std::span<const experiments::Experiment> all);

}  // namespace crspf::cli
