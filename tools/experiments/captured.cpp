#include "tools/experiments/captured.hpp"

#include <filesystem>
#include <utility>

#include "platform/files/input_error.hpp"
#include "platform/files/trajectory.hpp"
#include "platform/service/map_image.hpp"
#include "tools/crspf/sim_run.hpp"
#include "tools/experiments/runs.hpp"

namespace crspf::experiments {
namespace {

double mean_ms(const ReplayOutcome& outcome) {
    double sum = 0.0;
    for (const float ms : outcome.time_per_scan_ms) {
        sum += static_cast<double>(ms);
    }
    return sum / static_cast<double>(outcome.time_per_scan_ms.size());
}

}  // namespace

CapturedRun run_captured(cli::SimOptions options) {
    const std::filesystem::path out = options.out;
    std::filesystem::create_directories(out);
    options.capture = (out / "run.pcapng").string();
    const cli::SimRun simulated = cli::run_sim(options, [](double) {});
    ReplayJob job;
    job.logs = {options.capture};
    CapturedRun run{.error = {},
                    .outcome = run_replay(job),
                    .driven_m = simulated.result.driven_m,
                    .simulated_s = simulated.result.simulated_s};
    const auto error = eval::absolute_trajectory_error(run.outcome.trajectory, read_tum(out / "truth.tum"),
                                                       {.alignment = eval::Alignment::kFirstPose});
    if (!error) {
        throw InputError(options.capture + ": no pose of the replay has a true one; this is a fault of the experiment");
    }
    run.error = *error;
    std::filesystem::remove(options.capture);  // gigabytes add up
    return run;
}

Picture map_picture(const CapturedRun& run, std::string caption) {
    constexpr int kSide_px = 1400;
    const GridMap map =
        export_map(run.outcome.pipeline->map(), run.outcome.config.slam.map.resolution_m, run.outcome.far_tiles.get());
    return {.caption = std::move(caption), .image = draw_map(map, run.outcome.trajectory, kSide_px)};
}

Table captured_table(std::string caption) {
    return {.caption = std::move(caption),
            .head = {"run", "driven [m]", "scans", "position error, rms [m]", "largest [m]", "heading error, rms [deg]",
                     "processor time a scan [ms]"},
            .rows = {}};
}

void add_row(Table& table, std::string run, const CapturedRun& captured) {
    table.rows.push_back({std::move(run), text_of(captured.driven_m, 0),
                          std::to_string(captured.outcome.trajectory.size()), text_of(captured.error.position_m.rms, 3),
                          text_of(captured.error.position_m.max, 3), text_of(captured.error.heading_deg.rms, 2),
                          text_of(mean_ms(captured.outcome), 2)});
}

nlohmann::ordered_json to_json(const CapturedRun& run) {
    return {{"driven_m", run.driven_m},
            {"scans", run.outcome.trajectory.size()},
            {"rms_m", run.error.position_m.rms},
            {"max_m", run.error.position_m.max},
            {"end_m", run.error.end.position_m},
            {"heading_rms_deg", run.error.heading_deg.rms},
            {"scan_ms_mean", mean_ms(run.outcome)},
            {"digest", run.outcome.digest}};
}

}  // namespace crspf::experiments
