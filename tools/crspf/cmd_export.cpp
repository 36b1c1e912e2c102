#include <algorithm>
#include <array>
#include <cstdio>
#include <memory>
#include <string>
#include <utility>

#include "platform/files/grid_map.hpp"
#include "platform/files/input_error.hpp"
#include "platform/files/planning_map.hpp"
#include "tools/crspf/commands.hpp"
#include "tools/crspf/export_run.hpp"
#include "tools/crspf/run_options.hpp"

namespace crspf::cli {
namespace {

struct Output {
    const char* flag;
    ExportOutputs::Path ExportOutputs::*path;
    const char* type;
    const char* what;
};

constexpr std::array<Output, 9> kOutputs{{
    {"--mcap", &ExportOutputs::mcap, "FILE",
     "Everything as Foxglove and Lichtblick show it: pose, scans, map, match, diagnostics"},
    {"--tum", &ExportOutputs::tum, "FILE", "Trajectory: `timestamp tx ty tz qx qy qz qw` a line"},
    {"--kitti", &ExportOutputs::kitti, "FILE",
     "Trajectory: three rows of four numbers a line; x forward, y left, z up"},
    {"--carmen", &ExportOutputs::carmen, "FILE", "CARMEN log of scans and odometry, for other SLAM programs"},
    {"--csv", &ExportOutputs::csv, "FILE", "Table: what the filter made of each scan"},
    {"--svg", &ExportOutputs::svg, "FILE", "Drawing of the path over the map, with a scale"},
    {"--png", &ExportOutputs::png, "FILE", "Picture of the same"},
    {"--map", &ExportOutputs::map, "NAME", "Map for map_server and nav2, by this name without ending: .pgm and .yaml"},
    {"--planning", &ExportOutputs::planning, "NAME",
     "The same to plan paths on, lone marks taken out, obstacles a cell wider; also of a map: INPUT is its YAML"},
}};

struct ExportOptions {
    RunOptions run;
    std::array<std::string, kOutputs.size()> names;  ///< by kOutputs; empty: not wanted
};

ExportOutputs outputs_of(const ExportOptions& options) {
    ExportOutputs outputs;
    for (std::size_t i = 0; i < kOutputs.size(); ++i) {
        if (!options.names.at(i).empty()) {
            outputs.*kOutputs.at(i).path = options.names.at(i);
        }
    }
    return outputs;
}

bool is_map(const std::string& input) {
    return input.ends_with(".yaml") || input.ends_with(".yml");
}

void print_written(const std::vector<std::string>& files) {
    std::string list;
    for (const std::string& file : files) {
        list += (list.empty() ? "" : ", ") + file;
    }
    std::printf("written: %s\n", list.c_str());
}

/// Of a map that there is already.
void export_map_file(const ExportOptions& options, const ExportOutputs& outputs) {
    const std::string& input = options.run.inputs.front();
    const auto wanted = std::count_if(options.names.begin(), options.names.end(),
                                      [](const std::string& name) { return !name.empty(); });
    if (options.run.inputs.size() != 1 || !outputs.planning || wanted != 1) {
        throw InputError(input +
                         ": a map; by itself it can be exported with --planning NAME, all else is made of a run: "
                         "give its recording or log");
    }
    write_grid_map(planning_map(read_grid_map(input)), *outputs.planning);
    print_written({outputs.planning->string() + ".pgm", outputs.planning->string() + ".yaml"});
}

void run_export(const ExportOptions& options) {
    const ExportOutputs outputs = outputs_of(options);
    if (std::all_of(options.names.begin(), options.names.end(), [](const std::string& name) { return name.empty(); })) {
        std::string flags;
        for (const Output& output : kOutputs) {
            flags += std::string(" ") + output.flag;
        }
        throw InputError("nothing to export to; give the name of a file to at least one of" + flags);
    }
    if (is_map(options.run.inputs.front())) {
        export_map_file(options, outputs);
        return;
    }
    ReplayJob job = job_of(options.run);
    const ExportOutcome outcome = [&] {
        const ProgressBar bar;
        job.progress = [&bar](double share, std::uint64_t scans) { bar.show(share, scans); };
        return export_run(job, outputs);
    }();
    warn(outcome.log);
    warn_of_map(outcome.map_refused);
    print_sources(outcome.sources);
    std::printf("%llu scans\ndigest %s\n", static_cast<unsigned long long>(outcome.scans), outcome.digest.c_str());
    print_written(outcome.written);
}

}  // namespace

void add_export(CLI::App& app) {
    auto options = std::make_shared<ExportOptions>();
    CLI::App* command = app.add_subcommand("export", "Runs and maps in the forms that other programs want");
    add_run_options(*command, options->run);
    for (std::size_t i = 0; i < kOutputs.size(); ++i) {
        command->add_option(kOutputs.at(i).flag, options->names.at(i), kOutputs.at(i).what)
            ->type_name(kOutputs.at(i).type);
    }
    command->footer(
        "Plays the run once, as `crspf replay` does, and writes whatever is asked for. docs/recordings.md says what is "
        "in the files.\n\n"
        "Examples:\n"
        "  crspf export run.pcapng --mcap run.mcap\n"
        "  crspf export run.pcapng --carmen run.clf --tum run.tum\n"
        "  crspf export intel.clf.xz --map out/intel --svg out/intel.svg --csv out/intel.csv\n"
        "  crspf export second.pcapng --localize out/map.yaml --initial-pose 0 0 0 --kitti second.txt\n"
        "  crspf export out/run/map.yaml --planning out/run/planning");
    command->callback([options] { run_export(*options); });
}

}  // namespace crspf::cli
