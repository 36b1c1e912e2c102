// crspf eval: how good is a trajectory or a map, against the truth.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "platform/files/grid_map.hpp"
#include "platform/files/input_error.hpp"
#include "platform/files/trajectory.hpp"
#include "tools/crspf/commands.hpp"
#include "tools/eval/ate.hpp"
#include "tools/eval/map_error.hpp"
#include "tools/eval/relations.hpp"

namespace crspf::cli {
namespace {

using Json = nlohmann::ordered_json;

Json to_json(const eval::Summary& s) {
    return {{"mean", s.mean}, {"std", s.std}, {"rms", s.rms}, {"median", s.median}, {"p95", s.p95}, {"max", s.max}};
}

Json to_json(const Pose2& pose) {
    return {{"x_m", pose.x_m}, {"y_m", pose.y_m}, {"theta_deg", degrees(pose.theta_rad)}};
}

void print_json(const Json& json) {
    std::printf("%s\n", json.dump(2).c_str());
}

/// printf's own results are not looked at one by one: a full disk shows here.
void check_output() {
    if (std::fflush(stdout) != 0 || std::ferror(stdout) != 0) {
        throw InputError("standard output: cannot be written; free some space or send it elsewhere");
    }
}

void print_heading() {
    std::printf("%-28s %10s %10s %10s %10s %10s %10s\n", "", "mean", "std", "rms", "median", "95%", "max");
}

void print_summary(const char* name, const eval::Summary& s) {
    std::printf("%-28s %10.4f %10.4f %10.4f %10.4f %10.4f %10.4f\n", name, s.mean, s.std, s.rms, s.median, s.p95,
                s.max);
}

void print_alignment(const Pose2& pose) {
    std::printf("alignment: x %.4f m, y %.4f m, turn %.4f deg\n", pose.x_m, pose.y_m, degrees(pose.theta_rad));
}

// --- relations -------------------------------------------------------------------------------------------------------

struct RelationsCommand {
    std::filesystem::path trajectory;
    std::filesystem::path relations;
    bool json = false;

    void run() const {
        const std::vector<TimedPose> poses = read_tum(trajectory);
        const eval::RelationErrors errors = eval::relation_errors(poses, eval::read_relations(relations));
        const std::size_t used = errors.translation_m.count;
        if (used == 0) {
            throw InputError(trajectory.string() + ": no relation has poses within 0.5 s of both its stamps; is " +
                             relations.string() + " the truth of the same recording?");
        }
        if (json) {
            print_json({{"relations", used},
                        {"skipped", errors.skipped},
                        {"translation_m", to_json(errors.translation_m)},
                        {"translation_squared_m2", to_json(errors.translation_squared_m2)},
                        {"rotation_deg", to_json(errors.rotation_deg)},
                        {"rotation_squared_deg2", to_json(errors.rotation_squared_deg2)}});
            return;
        }
        std::printf("%zu relations, %zu skipped (no pose within 0.5 s)\n", used, errors.skipped);
        print_heading();
        print_summary("translation [m]", errors.translation_m);
        print_summary("translation squared [m^2]", errors.translation_squared_m2);
        print_summary("rotation [deg]", errors.rotation_deg);
        print_summary("rotation squared [deg^2]", errors.rotation_squared_deg2);
    }
};

void add_relations(CLI::App& eval) {
    const auto command = std::make_shared<RelationsCommand>();
    CLI::App* const sub = eval.add_subcommand(
        "relations", "Error by relations between poses (SLAM benchmark, Kuemmerle et al. 2009): no alignment needed");
    sub->add_option("TRAJECTORY", command->trajectory, "trajectory in TUM format")->required();
    sub->add_option("RELATIONS", command->relations, "lines t1 t2 dx dy dz roll pitch yaw; plain, .gz or .xz")
        ->required();
    sub->add_flag("--json", command->json, "print JSON");
    sub->footer("Example:\n  crspf eval relations intel.tum intel.relations.xz");
    sub->callback([command] {
        command->run();
        check_output();
    });
}

// --- ate -------------------------------------------------------------------------------------------------------------

struct AteCommand {
    std::filesystem::path trajectory;
    std::filesystem::path truth;
    double max_gap_s = eval::AteOptions{}.max_gap_s;
    bool no_align = false;
    std::array<double, 2> along{};
    bool has_along = false;
    bool json = false;

    void run() const {
        eval::AteOptions options{.max_gap_s = max_gap_s,
                                 .alignment = no_align ? eval::Alignment::kFirstPose : eval::Alignment::kBestFit};
        if (has_along) {
            const double length = std::hypot(along[0], along[1]);
            if (!(length > 0.0 && std::isfinite(length))) {
                throw InputError("--along: a direction of no length; give two numbers such as 1,0");
            }
            options.along = {.x = along[0] / length, .y = along[1] / length};
        }
        const std::vector<TimedPose> poses = read_tum(trajectory);
        const auto report = eval::absolute_trajectory_error(poses, read_tum(truth), options);
        if (!report) {
            throw InputError(trajectory.string() + ": no pose has a truth within " + std::to_string(max_gap_s) +
                             " s in " + truth.string() + "; check that both use one clock, or raise --max-gap");
        }
        if (json) {
            print_json(as_json(*report));
        } else {
            print(*report);
        }
    }

    [[nodiscard]] Json as_json(const eval::AteReport& report) const {
        Json end = {{"position_m", report.end.position_m}, {"heading_deg", report.end.heading_deg}};
        if (has_along) {
            end["along_m"] = report.end.along_m;
        }
        return {{"pairs", report.position_m.count},
                {"unmatched", report.unmatched},
                {"aligned_by", no_align ? "first pose" : "best fit"},
                {"alignment", to_json(report.P_truth_map)},
                {"position_m", to_json(report.position_m)},
                {"heading_deg", to_json(report.heading_deg)},
                {"end_aligned_at_first_pose", end}};
    }

    void print(const eval::AteReport& report) const {
        std::printf("%zu pairs, %zu poses without a truth within %g s; aligned by %s\n", report.position_m.count,
                    report.unmatched, max_gap_s, no_align ? "the first pose" : "best fit");
        print_alignment(report.P_truth_map);
        print_heading();
        print_summary("position [m]", report.position_m);
        print_summary("heading [deg]", report.heading_deg);
        std::printf("at the end, aligned at the first pose: position %.4f m, heading %+.4f deg", report.end.position_m,
                    report.end.heading_deg);
        if (has_along) {
            std::printf(", along the axis %+.4f m", report.end.along_m);
        }
        std::printf("\n");
    }
};

void add_ate(CLI::App& eval) {
    const auto command = std::make_shared<AteCommand>();
    CLI::App* const sub =
        eval.add_subcommand("ate", "Absolute trajectory error after a rigid alignment, and the error at the end");
    sub->add_option("TRAJECTORY", command->trajectory, "trajectory in TUM format")->required();
    sub->add_option("TRUTH", command->truth, "true trajectory in TUM format, same clock")->required();
    sub->add_option("--max-gap", command->max_gap_s, "[s] leave out poses without a truth this near in stamp")
        ->check(CLI::NonNegativeNumber)
        ->capture_default_str();
    sub->add_flag("--no-align", command->no_align, "align at the first pose instead of by best fit");
    CLI::Option* const along =
        sub->add_option("--along", command->along, "also the signed end error along this direction of the truth frame")
            ->type_name("X,Y")
            ->delimiter(',');
    sub->add_flag("--json", command->json, "print JSON");
    sub->footer(
        "Examples:\n"
        "  crspf eval ate run.tum truth.tum\n"
        "  crspf eval ate corridor.tum truth.tum --no-align --along 1,0");
    sub->callback([command, along] {
        command->has_along = along->count() > 0;
        command->run();
        check_output();
    });
}

// --- map -------------------------------------------------------------------------------------------------------------

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

}  // namespace

void add_eval(CLI::App& app) {
    CLI::App* const eval = app.add_subcommand("eval", "Measure a trajectory or a map against the truth");
    eval->require_subcommand(1);
    add_relations(*eval);
    add_ate(*eval);
    add_map(*eval);
}

}  // namespace crspf::cli
