// crspf eval: how good is a trajectory or a map, against the truth or against itself.
#include "tools/crspf/commands.hpp"
#include "tools/crspf/eval_commands.hpp"

namespace crspf::cli {

void add_eval(CLI::App& app) {
    CLI::App* const eval =
        app.add_subcommand("eval", "Measure a trajectory or a map against the truth, or a trajectory against itself");
    eval->require_subcommand(1);
    add_relations(*eval);
    add_ate(*eval);
    add_map(*eval);
    add_loops(*eval);
    add_match(*eval);
    add_relocalization(*eval);
    add_odometry(*eval);
}

}  // namespace crspf::cli
