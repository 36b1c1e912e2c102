// Recordings of real robots.
#include <algorithm>
#include <array>
#include <filesystem>
#include <optional>
#include <string_view>
#include <utility>

#include "platform/service/map_image.hpp"
#include "tools/crspf/replay.hpp"
#include "tools/eval/loops.hpp"
#include "tools/eval/relations.hpp"
#include "tools/experiments/experiment.hpp"
#include "tools/experiments/runs.hpp"

namespace crspf::experiments {
namespace {

struct Recording {
    const char* name;
    const char* file;       ///< below the data
    const char* relations;  ///< or empty
    const char* picture;    ///< file name of its map, or empty
    bool has_loops;         ///< large enough for them
};

constexpr std::array kRecordings{
    Recording{"intel", "carmen/intel.clf.xz", "carmen/intel.relations.xz", "intel", false},
    Recording{"aces", "carmen/aces.clf.xz", "", "", true},
    Recording{"URG-04LX, run 1", "urg04lx/breezyslam_exp1.dat.xz", "", "", false},
    Recording{"URG-04LX, run 3", "urg04lx/tinyslam_exp3.dat.xz", "", "", false},
};
/// The URG runs are of a robot whose lidar stands ahead of its axle.
Config config_for(const Recording& recording, std::uint64_t seed) {
    Config config;
    config.slam.particle_filter.seed = seed;
    if (std::string_view(recording.file).ends_with(".dat.xz")) {
        config.slam.lidar.P_base_lidar.x_m = 0.145;
        config.slam.lidar.range_max_m = 5.6;
        config.slam.lidar.time_per_beam_s = 0.1 / 1024.0;  // ten turns a second of 1024 steps
    }
    return config;
}

struct Run {
    double relation_m = 0.0;
    double relation_deg = 0.0;
    double mean_ms = 0.0;
    double cpu_s = 0.0;
    double median_match = 0.0;
    std::size_t scans = 0;
    std::string digest;
    std::optional<Picture> map;
    std::optional<eval::LoopErrors> loops;
};

Run replay_of(const Context& context, const Recording& recording, std::uint64_t seed) {
    ReplayJob job;
    job.logs = {context.data / recording.file};
    job.config = config_for(recording, seed);
    const ReplayOutcome outcome = run_replay(job);
    Run run;
    run.scans = outcome.trajectory.size();
    run.digest = outcome.digest;
    run.cpu_s = outcome.cpu_s;
    run.median_match = median_of({outcome.M.begin(), outcome.M.end()});
    for (const float ms : outcome.time_per_scan_ms) {
        run.mean_ms += static_cast<double>(ms) / static_cast<double>(run.scans);
    }
    if (*recording.relations != '\0') {
        const eval::RelationErrors errors =
            eval::relation_errors(outcome.trajectory, eval::read_relations(context.data / recording.relations));
        run.relation_m = errors.translation_m.mean;
        run.relation_deg = errors.rotation_deg.mean;
    }
    if (seed == 1) {
        constexpr int kSide_px = 1200;
        run.map = Picture{.caption = std::string(recording.name) + ", map and way, seed 1.",
                          .image = draw_map(export_map(outcome.pipeline->map(), outcome.config.slam.map.resolution_m),
                                            outcome.trajectory, kSide_px),
                          .file = recording.picture};
        if (recording.has_loops) {
            run.loops = eval::loop_errors(eval::read_scans(job.logs, *job.config), outcome.trajectory);
        }
    }
    return run;
}

Table table_of_loops(const eval::LoopErrors& loops) {
    Table table{.caption =
                    "Ends of the loops of aces.clf, each against its start (seed 1): what the trajectory says against "
                    "the scans of the two visits laid on each other.",
                .head = {"loop [m]", "revisits measured", "position [m]", "heading [deg]"},
                .rows = {}};
    for (const eval::LoopEnd& end : loops.ends) {
        table.rows.push_back({text_of(end.length_m, 0),
                              std::to_string(end.measured) + " of " + std::to_string(end.revisits),
                              end.measured > 0 ? text_of(end.position_m, 2) : "not measured",
                              end.measured > 0 ? text_of(end.heading_deg, 1) : ""});
    }
    return table;
}

}  // namespace

Findings logs(const Context& context) {
    std::vector<const Recording*> present;
    for (const Recording& recording : kRecordings) {
        if (!context.data.empty() && std::filesystem::exists(context.data / recording.file)) {
            present.push_back(&recording);
        }
    }
    if (present.empty()) {
        throw Skipped(
            "no recording is there; give --data DIR with carmen/intel.clf.xz and the others of docs/experiments.md");
    }
    const std::size_t seeds = context.seeds;
    std::vector<std::vector<Run>> runs(present.size(), std::vector<Run>(seeds));
    in_parallel(present.size() * seeds, context.progress, [&](std::size_t i) {
        runs[i / seeds][i % seeds] = replay_of(context, *present[i / seeds], i % seeds + 1);
    });

    Findings findings;
    findings.blocks.emplace_back(
        Paragraph{"Recordings of real robots with the defaults, but for what the URG's robot measures. Poses are those "
                  "known when "
                  "each scan came. The truth of intel is its relations between poses (Kuemmerle et al. 2009); the "
                  "others have none."});
    Table table{.caption = "Mean of " + std::to_string(seeds) + " seeds (worst).",
                .head = {"recording", "scans", "relations, mean error [m]", "[deg]", "match value, median",
                         "processor time a scan [ms]", "whole replay [s]"},
                .rows = {}};
    for (std::size_t r = 0; r < present.size(); ++r) {
        std::vector<double> metres;
        std::vector<double> degs;
        std::vector<double> ms;
        std::vector<double> seconds;
        for (const Run& run : runs[r]) {
            metres.push_back(run.relation_m);
            degs.push_back(run.relation_deg);
            ms.push_back(run.mean_ms);
            seconds.push_back(run.cpu_s);
            findings.figures[present[r]->name].push_back({{"relations_m", run.relation_m},
                                                          {"relations_deg", run.relation_deg},
                                                          {"scan_ms_mean", run.mean_ms},
                                                          {"cpu_s", run.cpu_s},
                                                          {"digest", run.digest}});
        }
        const bool truth = *present[r]->relations != '\0';
        table.rows.push_back({present[r]->name, std::to_string(runs[r][0].scans),
                              truth ? mean_and_worst(metres, 4) : "no truth", truth ? mean_and_worst(degs, 2) : "",
                              text_of(runs[r][0].median_match, 0), mean_and_worst(ms, 3), mean_and_worst(seconds, 2)});
        if (truth) {
            const Spread spread = spread_of(metres);
            findings.headlines.push_back(
                {.run = std::string(present[r]->name) + ".clf (SICK, 508 m) against its relations, mean absolute error",
                 .result = text_of(spread.mean, 4) + " m, " + text_of(spread_of(degs).mean, 2) + " deg (worst of " +
                           std::to_string(seeds) + " seeds " + text_of(spread.worst, 4) + " m)"});
        }
    }
    findings.blocks.emplace_back(std::move(table));
    for (std::vector<Run>& of_recording : runs) {
        if (of_recording[0].loops) {
            findings.blocks.emplace_back(table_of_loops(*of_recording[0].loops));
        }
        findings.blocks.emplace_back(std::move(*of_recording[0].map));
    }
    return findings;
}

}  // namespace crspf::experiments
