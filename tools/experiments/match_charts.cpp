#include "tools/experiments/match_charts.hpp"

#include <algorithm>
#include <cmath>
#include <tuple>

#include "core/base/trig.hpp"
#include "core/slam/particle_filter.hpp"

namespace crspf::experiments {

double quantile(std::vector<double> values, double share) {
    if (values.empty()) {
        return 0.0;
    }
    std::sort(values.begin(), values.end());
    return values[static_cast<std::size_t>(std::lround(share * static_cast<double>(values.size() - 1)))];
}

Chart chart_of_match(std::string caption, std::string file, const CarriedRun& run, const AnalyserParams& analyser) {
    Series M{.name = "M", .x = {}, .y = {}, .mark = Mark::kLine};
    for (const Matched& scan : run.scans) {
        M.x.push_back(scan.time_s);
        M.y.push_back(scan.result.M);
    }
    Chart chart{.caption = std::move(caption), .x_label = "time [s]", .y_label = "match value M", .series = {}};
    chart.series.push_back(std::move(M));
    chart.levels = {{"Result on", analyser.result_on},
                    {"Result off", analyser.result_off},
                    {"Draw on", analyser.draw_on},
                    {"Draw off", analyser.draw_off}};
    chart.file = std::move(file);
    return chart;
}

Chart chart_of_decisions(std::string caption, const CarriedRun& run) {
    // One above the other.
    constexpr double kHeight = 0.8;
    Series result{.name = "Result (2: 0, 2.8: 1)", .x = {}, .y = {}, .mark = Mark::kSteps};
    Series draw{.name = "Draw (1: 0, 1.8: 1)", .x = {}, .y = {}, .mark = Mark::kSteps};
    Series lost{.name = "lost (0: no, 0.8: yes)", .x = {}, .y = {}, .mark = Mark::kSteps};
    for (const Matched& scan : run.scans) {
        for (const auto& [series, base, on] :
             {std::tuple{&result, 2.0, scan.result.result}, std::tuple{&draw, 1.0, scan.result.draw},
              std::tuple{&lost, 0.0, scan.result.lost}}) {
            series->x.push_back(scan.time_s);
            series->y.push_back(base + (on ? kHeight : 0.0));
        }
    }
    Chart chart{.caption = std::move(caption), .x_label = "time [s]", .y_label = "off and on", .series = {}};
    chart.series = {std::move(result), std::move(draw), std::move(lost)};
    return chart;
}

Chart chart_of_error(std::string caption, const std::vector<std::pair<std::string, const CarriedRun*>>& runs) {
    Chart chart{
        .caption = std::move(caption), .x_label = "time [s]", .y_label = "from the true pose [m]", .series = {}};
    for (const auto& [name, run] : runs) {
        Series series{.name = name, .x = {}, .y = {}, .mark = Mark::kLine};
        for (const Matched& scan : run->scans) {
            series.x.push_back(scan.time_s);
            series.y.push_back(scan.off_m);
        }
        chart.series.push_back(std::move(series));
    }
    return chart;
}

Chart chart_of_feedback(const ParticleFilterParams& params) {
    Series range{.name = "range X, Y [cm]", .x = {}, .y = {}, .mark = Mark::kLine};
    Series turn{.name = "range A [deg]", .x = {}, .y = {}, .mark = Mark::kLine};
    Series number{.name = "particles", .x = {}, .y = {}, .mark = Mark::kLine};
    constexpr double kCentimetres = 100.0;
    constexpr int kSteps = 160;
    for (int i = 0; i <= kSteps; ++i) {
        const double M = (params.match_max + params.match_min) * i / kSteps;
        const auto by_match = [&](double at_best, double at_worst) {
            return feedback(M, params.match_min, params.match_max, at_best, at_worst);
        };
        const double particles =
            by_match(static_cast<double>(params.particles_min), static_cast<double>(params.particles_max));
        for (const auto& [series, value] :
             {std::pair{&range, kCentimetres * by_match(params.range_min_m, params.range_max_m)},
              std::pair{&turn, degrees(by_match(params.angle_min_rad, params.angle_max_rad))},
              std::pair{&number, particles}}) {
            series->x.push_back(M);
            series->y.push_back(value);
        }
    }
    Chart chart{.caption = "The feedback (9): range and number of particles by the last match value",
                .x_label = "M(t-1)",
                .y_label = "range [cm], [deg]; number",
                .series = {}};
    chart.series = {std::move(range), std::move(turn), std::move(number)};
    chart.log_y = true;
    chart.file = "match-feedback";
    return chart;
}

Chart chart_of_effort(const CarriedRun& run, const ParticleFilterParams& params) {
    Series number{.name = "particles by (9)", .x = {}, .y = {}, .mark = Mark::kLine};
    Series spent{.name = "evaluations spent", .x = {}, .y = {}, .mark = Mark::kLine};
    double M = 0.0;  // of the scan before
    for (const Matched& scan : run.scans) {
        number.x.push_back(scan.time_s);
        number.y.push_back(feedback(M, params.match_min, params.match_max, static_cast<double>(params.particles_min),
                                    static_cast<double>(params.particles_max)));
        spent.x.push_back(scan.time_s);
        spent.y.push_back(static_cast<double>(scan.result.evaluations));
        M = scan.result.M;
    }
    Chart chart{.caption = "Known map, carried every 20 s: particles by (9), and evaluations of (10) that were spent",
                .x_label = "time [s]",
                .y_label = "number a scan",
                .series = {}};
    chart.series = {std::move(number), std::move(spent)};
    chart.log_y = true;
    return chart;
}

}  // namespace crspf::experiments
