// The sub-commands of `crspf eval`, a file each.
#pragma once

#include <CLI/CLI.hpp>

namespace crspf::cli {

/// As the commands of commands.hpp, but below `eval`.
void add_relations(CLI::App& eval);
void add_ate(CLI::App& eval);
void add_map(CLI::App& eval);
void add_loops(CLI::App& eval);
void add_match(CLI::App& eval);
void add_relocalization(CLI::App& eval);
void add_odometry(CLI::App& eval);

}  // namespace crspf::cli
