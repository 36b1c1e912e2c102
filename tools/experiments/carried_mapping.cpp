#include "tools/experiments/carried_mapping.hpp"

#include <algorithm>

#include "tools/experiments/carried_run.hpp"
#include "tools/experiments/match_charts.hpp"
#include "tools/experiments/runs.hpp"

namespace crspf::experiments {
namespace {

constexpr double kRight_m = 0.25;
constexpr double kWrong_m = 0.5;

}  // namespace

Mapping carry_while_mapping(const sim::SampleDrive& drive, const SlamParams& params,
                            const std::function<void(double)>& progress) {
    constexpr std::size_t kFirst = 300;
    constexpr std::size_t kApart = 300;
    constexpr std::size_t kTimes = 7;
    constexpr std::size_t kWatched = 100;
    constexpr std::size_t kLater = 20;
    std::vector<CarriedRun> runs(kTimes * kTold.size());
    std::vector<std::size_t> at(runs.size());
    in_parallel(runs.size(), progress, [&](std::size_t i) {
        at[i] = kFirst + kApart * (i / kTold.size());
        const Carry carry{.scan = at[i], .P_base_told = kTold[i % kTold.size()]};
        runs[i] = run_drive(drive, {.params = params, .carries = {carry}, .scans_max = at[i] + kWatched});
    });
    Mapping mapping;
    for (std::size_t i = 0; i < runs.size(); ++i) {
        const auto begin = runs[i].scans.begin() + static_cast<std::ptrdiff_t>(at[i]);
        const auto end = runs[i].scans.end();
        ++mapping.carried;
        mapping.draw_off += std::any_of(begin, end, [](const Matched& s) { return !s.result.draw; }) ? 1U : 0U;
        mapping.lost += std::any_of(begin, end, [](const Matched& s) { return s.result.lost; }) ? 1U : 0U;
        mapping.right += runs[i].scans.back().off_m <= kRight_m ? 1U : 0U;
        mapping.before.push_back((begin - 1)->result.M);
        mapping.first.push_back(begin->result.M);
        if ((begin + kLater)->off_m > kWrong_m) {
            mapping.later.push_back((begin + kLater)->result.M);
        }
    }
    return mapping;
}

Table table_of_mapping(const std::vector<std::pair<std::string, const Mapping*>>& settings) {
    Table table{.caption = "Robots that are carried 1.5 m while they make their map, at different places; 10 s each",
                .head = {"thresholds", "carried", "median M before", "M of the first scan", "M 2 s later, still wrong",
                         "Draw = 0", "taken for lost", "right again"},
                .rows = {}};
    for (const auto& [name, m] : settings) {
        table.rows.push_back({name, std::to_string(m->carried), text_of(quantile(m->before, 0.5), 0),
                              text_of(quantile(m->first, 0.5), 0), text_of(quantile(m->later, 0.5), 0),
                              std::to_string(m->draw_off), std::to_string(m->lost), std::to_string(m->right)});
    }
    return table;
}

Claim not_drawn(const Mapping& shipped, const Mapping& strict, const AnalyserParams& analyser,
                const AnalyserParams& stricter) {
    const auto of = [](std::size_t part, const Mapping& m) {
        return std::to_string(part) + " of " + std::to_string(m.carried);
    };
    Claim claim{.paper =
                    "Draw = 0 prevents plenty of error scans from being drawn in the map when the robot moves "
                    "hastily (5).",
                .measured = "Of robots that were carried 1.5 m while mapping, Draw went off for " +
                            of(shipped.draw_off, shipped) + ", and " + of(shipped.lost, shipped) +
                            " were taken for lost within 10 s.",
                .verdict = 10 * shipped.draw_off >= 9 * shipped.carried ? Verdict::kHolds
                           : 2 * shipped.draw_off >= shipped.carried    ? Verdict::kPartly
                                                                        : Verdict::kDoesNotHold};
    if (claim.verdict != Verdict::kHolds) {
        claim.reason = "M falls from " + text_of(quantile(shipped.before, 0.5), 0) + " to " +
                       text_of(quantile(shipped.first, 0.5), 0) +
                       " (medians) with the first scan at the wrong pose, but seldom below Draw off, " +
                       text_of(analyser.draw_off, 0) +
                       ". So that scan is drawn, the next ones match what it drew, and M is at " +
                       text_of(quantile(shipped.later, 0.5), 0) + " again 2 s later. With Draw off at " +
                       text_of(stricter.draw_off, 0) + " and on at " + text_of(stricter.draw_on, 0) +
                       " it went off for " + of(strict.draw_off, strict) + ", and " + of(strict.lost, strict) +
                       " were taken for lost; the others matched better than that from the first scan on.";
    }
    return claim;
}

nlohmann::ordered_json figures_of(const Mapping& m) {
    return {{"carried", m.carried},
            {"M_before", quantile(m.before, 0.5)},
            {"M_first", quantile(m.first, 0.5)},
            {"M_later", quantile(m.later, 0.5)},
            {"draw_off", m.draw_off},
            {"lost", m.lost},
            {"right", m.right}};
}

}  // namespace crspf::experiments
