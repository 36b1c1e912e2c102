#include "tools/experiments/methods.hpp"

#include <algorithm>
#include <utility>

namespace crspf::experiments {
namespace {

double mean_of(const std::vector<double>& values) {
    return spread_of(values).mean;
}

std::vector<std::string> row_of(const std::string& name, const std::vector<DriveError>& errors,
                                const std::string& time) {
    std::vector<double> rms_m;
    std::vector<double> max_m;
    std::vector<double> heading_deg;
    std::size_t failed = 0;
    for (const DriveError& error : errors) {
        rms_m.push_back(error.rms_m);
        max_m.push_back(error.max_m);
        heading_deg.push_back(error.heading_max_deg);
        failed += error.failed() ? 1U : 0U;
    }
    return {name,
            text_of(mean_of(rms_m), 3),
            text_of(spread_of(rms_m).worst, 3),
            text_of(mean_of(max_m), 3),
            text_of(mean_of(heading_deg), 2),
            std::to_string(failed) + " of " + std::to_string(errors.size()),
            time};
}

nlohmann::ordered_json errors_to_json(const std::vector<DriveError>& errors) {
    nlohmann::ordered_json all = nlohmann::ordered_json::array();
    for (const DriveError& error : errors) {
        all.push_back({{"rms_m", error.rms_m},
                       {"max_m", error.max_m},
                       {"end_m", error.end_m},
                       {"heading_max_deg", error.heading_max_deg}});
    }
    return all;
}

}  // namespace

void remove_additions(SlamParams& params) {
    params.particle_filter.refinement = false;
    params.particle_filter.degeneracy = false;
    params.particle_filter.pull_weight = 0.0;
    params.map.behind_cells = 0;
    params.critical_rays.weight = 10.0;
}

void remove_ideas(SlamParams& params) {
    params.particle_filter.feedback = false;
    params.critical_rays.enabled = false;
    params.map.remove_errors = false;
}

Method as_shipped() {
    return {.name = "as shipped", .change = [](SlamParams&) {}};
}

Method paper_alone() {
    return {.name = "the paper's four ideas alone", .change = remove_additions};
}

Method tinyslam_way() {
    return {.name = "TinySLAM's way",
            .change =
                [](SlamParams& params) {
                    remove_additions(params);
                    remove_ideas(params);
                    params.deskew = false;
                },
            .in_step = true};
}

Spread MethodRuns::rms_m() const {
    std::vector<double> values;
    for (const DriveError& error : errors) {
        values.push_back(error.rms_m);
    }
    return spread_of(values);
}

std::size_t MethodRuns::failed() const {
    return static_cast<std::size_t>(
        std::count_if(errors.begin(), errors.end(), [](const DriveError& error) { return error.failed(); }));
}

Comparison compare(const Context& context, std::size_t seeds,
                   const std::function<sim::SampleDrive(std::uint64_t seed)>& drive_of,
                   const std::vector<Method>& methods, const OnPlayed& on_played) {
    Comparison comparison;
    comparison.odometry.resize(seeds);
    for (const Method& method : methods) {
        MethodRuns& runs = comparison.methods.emplace_back();
        runs.name = method.name;
        runs.errors.resize(seeds);
        runs.scan_ms.resize(seeds);
    }
    in_parallel(seeds, context.progress, [&](std::size_t index) {
        const std::size_t seed = index + 1;
        const sim::SampleDrive drive = drive_of(seed);
        const sim::SampleDrive stepped = in_step(drive);
        comparison.odometry[index] = odometry_error(drive);
        if (index == 0) {
            comparison.driven_m = drive.driven_m;
            comparison.scans = drive.steps.size();
        }
        for (std::size_t m = 0; m < methods.size(); ++m) {
            SlamParams params = params_for(drive, seed);
            methods[m].change(params);
            const Played played = play(methods[m].in_step ? stepped : drive, params);
            comparison.methods[m].errors[index] = error_of(played.poses, drive.truth);
            comparison.methods[m].scan_ms[index] = mean_of(played.scan_ms);
            if (on_played) {
                on_played(m, seed, drive, played);
            }
        }
    });
    return comparison;
}

Table table_of(const Comparison& comparison, std::string caption) {
    Table table{.caption = std::move(caption),
                .head = {"method", "position error, rms [m], mean of seeds", "worst seed", "largest on the way, mean",
                         "heading, largest, mean [deg]", "failed (over 1 m off)", "processor time a scan [ms]"},
                .rows = {}};
    for (const MethodRuns& runs : comparison.methods) {
        table.rows.push_back(row_of(runs.name, runs.errors, text_of(mean_of(runs.scan_ms), 3)));
    }
    table.rows.push_back(row_of("odometry alone", comparison.odometry, ""));
    return table;
}

nlohmann::ordered_json to_json(const Comparison& comparison) {
    nlohmann::ordered_json json;
    json["driven_m"] = comparison.driven_m;
    json["scans"] = comparison.scans;
    for (const MethodRuns& runs : comparison.methods) {
        json["methods"][runs.name] = {{"rms_m_mean", runs.rms_m().mean},
                                      {"rms_m_worst", runs.rms_m().worst},
                                      {"failed", runs.failed()},
                                      {"scan_ms_mean", mean_of(runs.scan_ms)},
                                      {"seeds", errors_to_json(runs.errors)}};
    }
    json["odometry"] = errors_to_json(comparison.odometry);
    return json;
}

}  // namespace crspf::experiments
