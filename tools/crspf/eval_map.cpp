// crspf eval map.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <memory>

#include "platform/files/grid_map.hpp"
#include "platform/files/input_error.hpp"
#include "tools/crspf/eval_commands.hpp"
#include "tools/crspf/eval_output.hpp"
#include "tools/eval/map_error.hpp"

namespace crspf::cli {
namespace {

struct MapCommand {
    std::filesystem::path built;
    std::filesystem::path truth;
    std::array<double, 3> initial{};
    double window_m = eval::AlignmentWindow{}.half_width_m;
    double window_deg = degrees(eval::AlignmentWindow{}.half_turn_rad);
    bool json = false;

    void run() const {
        if (!std::all_of(initial.begin(), initial.end(), [](double v) { return std::isfinite(v); })) {
            throw InputError("--initial: not a finite number; give x and y in metres and the turn in degrees");
        }
        const GridMap built_map = read(built);
        const eval::MapError error = eval::map_error(
            built_map, read(truth),
            {.P_truth_built = {.x_m = initial[0], .y_m = initial[1], .theta_rad = wrap_angle(radians(initial[2]))},
             .half_width_m = window_m,
             .half_turn_rad = radians(window_deg)});
        if (json) {
            print_json(as_json(error));
        } else {
            print(error);
        }
    }

    static GridMap read(const std::filesystem::path& yaml) {
        GridMap map = read_grid_map(yaml);
        if (std::find(map.cells.begin(), map.cells.end(), GridCell::kOccupied) == map.cells.end()) {
            throw InputError(yaml.string() + ": no occupied cell; check occupied_thresh, negate and the image");
        }
        return map;
    }

    static Json as_json(const eval::MapError& error) {
        const auto figure = [&error](double metres) { return Json{{"m", metres}, {"cells", metres / error.cell_m}}; };
        return {{"alignment", to_json(error.P_truth_built)},
                {"at_window_edge", error.at_window_edge},
                {"lies_elsewhere", error.lies_elsewhere},
                {"cell_m", error.cell_m},
                {"built_cells", error.built_to_truth_m.count},
                {"truth_cells", error.truth_to_built_m.count},
                {"sum_per_truth_cell", figure(error.sum_per_truth_cell_m())},
                {"sum_per_built_cell", figure(error.built_to_truth_m.mean)},
                {"built_to_truth_p95", figure(error.built_to_truth_m.p95)},
                {"truth_to_built_mean", figure(error.truth_to_built_m.mean)},
                {"truth_to_built_p95", figure(error.truth_to_built_m.p95)}};
    }

    static void print(const eval::MapError& error) {
        print_alignment(error.P_truth_built);
        if (error.at_window_edge) {
            std::printf(
                "warning: at the edge of the search window; widen --window-m, --window-deg or give --initial\n");
        }
        if (error.lies_elsewhere) {
            std::printf(
                "warning: most of the built map is nowhere near the truth; --initial says where its frame lies (the "
                "robot's true start)\n");
        }
        std::printf("occupied cells of %g m: %zu built, %zu true\n", error.cell_m, error.built_to_truth_m.count,
                    error.truth_to_built_m.count);
        std::printf("%-44s %10s %10s\n", "distance to the nearest occupied cell", "[m]", "[cells]");
        const auto line = [&error](const char* name, double metres) {
            std::printf("%-44s %10.4f %10.4f\n", name, metres, metres / error.cell_m);
        };
        line("built to truth, sum / true cells", error.sum_per_truth_cell_m());
        line("built to truth, sum / built cells (mean)", error.built_to_truth_m.mean);
        line("built to truth, 95%", error.built_to_truth_m.p95);
        line("truth to built, mean", error.truth_to_built_m.mean);
        line("truth to built, 95%", error.truth_to_built_m.p95);
    }
};

}  // namespace

void add_map(CLI::App& eval) {
    const auto command = std::make_shared<MapCommand>();
    CLI::App* const sub = eval.add_subcommand(
        "map", "Nearest-neighbour error of a built map (Santos et al. 2013) after a rigid alignment to the true map");
    sub->add_option("BUILT", command->built, "YAML of the built map (map_server format)")->required();
    sub->add_option("TRUTH", command->truth, "YAML of the true map")->required();
    sub->add_option("--initial", command->initial,
                    "where the built map's frame lies in the truth's [m, deg]: the middle of the search; default 0,0,0")
        ->type_name("X,Y,DEG")
        ->delimiter(',');
    sub->add_option("--window-m", command->window_m, "[m] the alignment moves the map at most this far in x and in y")
        ->check(CLI::Range(0.0, 1000.0))
        ->capture_default_str();
    sub->add_option("--window-deg", command->window_deg, "[deg] and turns it at most this far, about its middle")
        ->check(CLI::Range(0.0, 180.0))
        ->capture_default_str();
    sub->add_flag("--json", command->json, "print JSON");
    sub->footer(
        "Examples:\n"
        "  crspf eval map run.yaml truth.yaml\n"
        "  crspf eval map run.yaml truth.yaml --initial 6.0,2.5,90 --window-m 1\n"
        "  crspf eval map run.yaml truth.yaml --window-m 0 --window-deg 0    # no alignment");
    sub->callback([command] {
        command->run();
        check_output();
    });
}

}  // namespace crspf::cli
