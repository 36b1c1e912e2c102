#include <cstdio>
#include <memory>
#include <string>

#include "platform/files/grid_map.hpp"
#include "platform/files/planning_map.hpp"
#include "tools/crspf/commands.hpp"

namespace crspf::cli {

void add_export(CLI::App& app) {
    struct Options {
        std::string map;
        std::string planning;
    };
    auto options = std::make_shared<Options>();
    CLI::App* command = app.add_subcommand("export", "Makes of a map what other programs want");
    command->footer(
        "A map to plan paths on has its lone marks taken out by a median filter, and its obstacles expanded by a "
        "cell.\n"
        "\n"
        "Example:\n"
        "  crspf export out/run/map.yaml --planning out/run/planning    writes planning.pgm and planning.yaml");
    command->add_option("MAP", options->map, "YAML of the map (map_server format)")->required();
    command->add_option("--planning", options->planning, "write a map to plan paths on, by this name without ending")
        ->required();
    command->callback([options] {
        write_grid_map(planning_map(read_grid_map(options->map)), options->planning);
        std::printf("written: %s.pgm, %s.yaml\n", options->planning.c_str(), options->planning.c_str());
    });
}

}  // namespace crspf::cli
