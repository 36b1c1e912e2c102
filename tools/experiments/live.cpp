// Figs. 13 and 14: the service in real time: when its modules work, what they use, and what comes of it.
#include <algorithm>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "tools/experiments/experiment.hpp"
#include "tools/experiments/live_run.hpp"
#include "tools/experiments/runs.hpp"
#include "tools/experiments/taped_robot.hpp"

namespace crspf::experiments {
namespace {

constexpr double kWatched_s = 30.0;
constexpr double kMillimetres = 1000.0;

double offset_m(const Pose2& a, const Pose2& b) {
    return std::hypot(a.x_m - b.x_m, a.y_m - b.y_m);
}

/// The poses of the run, scan by scan, in the frame of the map.
struct Way {
    std::vector<double> time_s;
    std::vector<Pose2> observed;  ///< P~
    std::vector<Pose2> found;     ///< P
    std::vector<Pose2> odometry;  ///< that nobody corrects
    std::vector<Pose2> truth;     ///< empty: not known
};

Way way_of(const std::vector<LiveScan>& scans) {
    Way way;
    const bool known = std::all_of(scans.begin(), scans.end(), [](const LiveScan& s) { return s.P_world_base; });
    Pose2 P_odometry;
    for (std::size_t i = 0; i < scans.size(); ++i) {
        const ScanResult& result = scans[i].result;
        way.time_s.push_back((result.stamp - scans.front().result.stamp).seconds());
        way.observed.push_back(result.P_map_observed);
        way.found.push_back(result.P_map_base);
        // P~ goes on from the last P by what the wheels said since.
        P_odometry =
            i == 0 ? result.P_map_base : P_odometry * (inverse(scans[i - 1].result.P_map_base) * result.P_map_observed);
        way.odometry.push_back(P_odometry);
        if (known) {
            // The map's frame is laid through the first pose: it differs from the world's by the start alone.
            way.truth.push_back(scans.front().result.P_map_base *
                                (inverse(*scans.front().P_world_base) * *scans[i].P_world_base));
        }
    }
    return way;
}

std::vector<double> errors_m(const std::vector<Pose2>& poses, const std::vector<Pose2>& truth) {
    std::vector<double> off_m;
    for (std::size_t i = 0; i < truth.size(); ++i) {
        off_m.push_back(offset_m(poses[i], truth[i]));
    }
    return off_m;
}

Chart chart(std::string caption, std::string y_label, std::vector<Series> series) {
    return {.caption = std::move(caption),
            .x_label = "time [s]",
            .y_label = std::move(y_label),
            .series = std::move(series)};
}

template <typename Value>
Series series_of(std::string name, const std::vector<LiveScan>& scans, Mark mark, Value value) {
    Series series{.name = std::move(name), .x = {}, .y = {}, .mark = mark};
    for (const LiveScan& scan : scans) {
        series.x.push_back((scan.result.stamp - scans.front().result.stamp).seconds());
        series.y.push_back(value(scan.result));
    }
    return series;
}

Chart chart_of_loads(const LiveRun& run) {
    std::vector<Series> series;
    for (const ModuleLoad& module : run.modules) {
        Series line{.name = module.name, .x = run.interval_s, .y = {}, .mark = Mark::kSteps};
        for (const double share : module.share) {
            line.y.push_back(100.0 * share);
        }
        series.push_back(std::move(line));
    }
    Chart loads = chart("Processor load of each module, URG at 10 Hz", "% of a core", std::move(series));
    loads.file = "live-load";
    return loads;
}

void add_charts(Findings& found, const LiveRun& run, const Way& way, const AnalyserParams& analyser) {
    const std::vector<LiveScan>& scans = run.scans;
    constexpr double kResultAt = 2700.0;  // above M
    constexpr double kDrawnAt = 2400.0;
    constexpr double kHeight = 200.0;
    Chart match = chart("The filter's match value and Result, and when the map was drawn", "match value M",
                        {series_of("M", scans, Mark::kLine, [](const ScanResult& r) { return r.M; }),
                         series_of("Result (up: 1)", scans, Mark::kSteps,
                                   [](const ScanResult& r) { return kResultAt + (r.result ? kHeight : 0.0); }),
                         series_of("map update (up: drawn)", scans, Mark::kSteps,
                                   [](const ScanResult& r) { return kDrawnAt + (r.to_draw ? kHeight : 0.0); })});
    match.levels = {{"Result on", analyser.result_on}, {"Result off", analyser.result_off}};
    match.file = "live-match";
    found.blocks.emplace_back(std::move(match));

    found.blocks.emplace_back(
        chart("The observed pose P~ of the odometry and the pose P that was found: x and y", "[m]",
              {series_of("x of P~", scans, Mark::kDots, [](const ScanResult& r) { return r.P_map_observed.x_m; }),
               series_of("x of P", scans, Mark::kLine, [](const ScanResult& r) { return r.P_map_base.x_m; }),
               series_of("y of P~", scans, Mark::kDots, [](const ScanResult& r) { return r.P_map_observed.y_m; }),
               series_of("y of P", scans, Mark::kLine, [](const ScanResult& r) { return r.P_map_base.y_m; })}));
    found.blocks.emplace_back(chart("What each correction moved the pose by: from P~ to P", "[mm]",
                                    {series_of("|P - P~|", scans, Mark::kLine, [](const ScanResult& r) {
                                        return kMillimetres * offset_m(r.P_map_base, r.P_map_observed);
                                    })}));
    if (!way.truth.empty()) {
        found.blocks.emplace_back(
            chart("The odometer's error, and what is left of it", "from the true pose [m]",
                  {{.name = "odometry alone", .x = way.time_s, .y = errors_m(way.odometry, way.truth)},
                   {.name = "P~ at each scan", .x = way.time_s, .y = errors_m(way.observed, way.truth)},
                   {.name = "P", .x = way.time_s, .y = errors_m(way.found, way.truth)}}));
    }
    found.blocks.emplace_back(chart("Evaluations of the match value, by the filter", "a scan",
                                    {series_of("evaluations", scans, Mark::kLine, [](const ScanResult& r) {
                                        return static_cast<double>(r.evaluations);
                                    })}));
    found.blocks.emplace_back(chart_of_loads(run));
}

double replay_load(const LiveRun& run) {
    return 1e-3 * run.replay_scan_ms * TapedRobot::kScanRate_hz;
}

Table table_of(const LiveRun& run) {
    Table table{.caption = "The modules of the service in " + text_of(run.seconds, 0) + " s of real time",
                .head = {"module", "rate [Hz]", "load [% of a core]", "a turn, median below [us]", "longest [us]",
                         "deadlines missed"},
                .rows = {}};
    for (const ModuleLoad& module : run.modules) {
        const bool told = module.max_us > 0.0;
        table.rows.push_back({module.name, module.rate_hz > 0.0 ? text_of(module.rate_hz, 1) : "",
                              text_of(100.0 * module.cpu_s / run.seconds, 2),
                              told ? text_of(module.median_below_us, 0) : "", told ? text_of(module.max_us, 0) : "",
                              told ? std::to_string(module.misses) : ""});
    }
    table.rows.push_back({"all", "", text_of(100.0 * run.load(), 2), "", "", ""});
    table.rows.push_back({"the same robot in a replay, one thread", text_of(TapedRobot::kScanRate_hz, 1),
                          text_of(100.0 * replay_load(run), 2), "", "", ""});
    return table;
}

const ModuleLoad& module_of(const LiveRun& run, const std::string& name) {
    return *std::find_if(run.modules.begin(), run.modules.end(), [&](const ModuleLoad& m) { return m.name == name; });
}

void add_figures(Findings& found, const LiveRun& run) {
    for (const ModuleLoad& module : run.modules) {
        found.figures["modules"][module.name] = {{"rate_hz", module.rate_hz},
                                                 {"load", module.cpu_s / run.seconds},
                                                 {"median_below_us", module.median_below_us},
                                                 {"max_us", module.max_us},
                                                 {"misses", module.misses}};
    }
    found.figures["seconds"] = run.seconds;
    found.figures["load"] = run.load();
    found.figures["replay_load"] = replay_load(run);
    found.figures["sched_fifo"] = run.realtime;
    found.figures["skipped_scans"] = run.skipped_scans;
    found.figures["undrawn_scans"] = run.undrawn;
    found.figures["replay_same"] = run.live_same;
    found.figures["replay_other"] = run.live_other;
}

Claim rates(const LiveRun& run) {
    constexpr double kNear = 0.05;
    const double odometer_hz = 1.0 / TapedRobot::kWheelPeriod_s;
    const double odometry_hz = module_of(run, "odometry").rate_hz;
    const double filter_hz = module_of(run, "filter").rate_hz;
    const bool kept = std::abs(odometry_hz - odometer_hz) <= kNear * odometer_hz &&
                      std::abs(filter_hz - TapedRobot::kScanRate_hz) <= kNear * TapedRobot::kScanRate_hz;
    Claim claim{.paper =
                    "The modules work asynchronously, each at a rate of its own (6, Fig. 13): odometry at 10 Hz, "
                    "particle filtering at 3 Hz, the map when it is told to.",
                .measured = "Odometry " + text_of(odometry_hz, 1) + " Hz, filter " + text_of(filter_hz, 1) +
                            " Hz (each scan), map " + text_of(module_of(run, "map").rate_hz, 1) + " Hz, output " +
                            text_of(module_of(run, "output").rate_hz, 1) + " Hz; " + std::to_string(run.skipped_scans) +
                            " scans skipped.",
                .verdict = kept ? Verdict::kHolds : Verdict::kPartly};
    if (!kept) {
        claim.reason =
            "A sensor's rate was not kept: the machine was busy with something else, or the sensors' threads "
            "were late themselves.";
    }
    return claim;
}

Claim drift(const Way& way, nlohmann::ordered_json& figures) {
    Claim claim{.paper = "The cumulative error of the odometer is eliminated by scan matching (6, Fig. 13).",
                .measured = "The true way could not be told."};
    const std::vector<double> odometry_m = errors_m(way.odometry, way.truth);
    const std::vector<double> found_m = errors_m(way.found, way.truth);
    if (odometry_m.empty()) {
        return claim;
    }
    const double worst_odometry_m = *std::max_element(odometry_m.begin(), odometry_m.end());
    const double worst_m = *std::max_element(found_m.begin(), found_m.end());
    figures["odometry_alone_max_m"] = worst_odometry_m;
    figures["pose_max_m"] = worst_m;
    constexpr double kEliminated = 0.25;
    claim.measured = "Odometry alone is up to " + text_of(worst_odometry_m, 2) + " m off, the pose up to " +
                     text_of(worst_m, 2) + " m.";
    claim.verdict = worst_m <= kEliminated * worst_odometry_m ? Verdict::kHolds
                    : worst_m < worst_odometry_m              ? Verdict::kPartly
                                                              : Verdict::kDoesNotHold;
    if (claim.verdict != Verdict::kHolds) {
        claim.reason = "In " + text_of(way.time_s.back(), 0) +
                       " s the odometer hardly drifts: the meeting room and the corridor show longer drives.";
    }
    return claim;
}

}  // namespace

Findings live(const Context& context) {
    const std::filesystem::path directory = context.scratch / "live";
    std::filesystem::create_directories(directory);
    const LiveRun run = run_live(directory, kWatched_s, context.progress);
    std::filesystem::remove_all(directory);

    Findings found;
    found.blocks.emplace_back(Paragraph{
        "The service runs in real time, within this process: a simulated URG speaks SCIP on a pseudo terminal, the "
        "wheels' counts come as frames of a CAN bus 50 times a second, and the pose leaves on another bus. The robot "
        "drives through the office. Loads are the kernel's account of each thread's processor time (schedstat); the "
        "sensors' own threads are left out. " +
        std::string(run.realtime ? "The real-time threads ran under SCHED_FIFO."
                                 : "SCHED_FIFO was not to be had: the threads were ordinary ones.")});
    add_figures(found, run);
    found.blocks.emplace_back(table_of(run));
    found.blocks.emplace_back(
        Paragraph{"The recording of this run, played again in one thread, gives " + std::to_string(run.live_same) +
                  " poses that are the service's to the bit, and " + std::to_string(run.live_other) +
                  " that are not. What the charts show of poses and match values comes from there."});
    const Way way = way_of(run.scans);
    add_charts(found, run, way, AnalyserParams{});

    found.claims.push_back({.paper = "CRSPF-SLAM is among the methods with a low processor load (7, Fig. 14).",
                            .measured = percent_of(run.load(), 2) +
                                        " of a core for the whole service with the URG at 10 Hz; " +
                                        percent_of(replay_load(run), 2) + " for the SLAM alone, in one thread.",
                            .verdict = Verdict::kNotMeasured,
                            .reason = "The load is measured, the comparison is not: no other method is run here."});
    found.claims.push_back(rates(run));
    found.claims.push_back(drift(way, found.figures));
    found.headlines.push_back({"load of the live service, URG at 10 Hz, one core", percent_of(run.load(), 2)});
    return found;
}

}  // namespace crspf::experiments
