// Experiments that take no time: one that finds, one that skips, two that fail; and what the first one finds.
#pragma once

#include <array>
#include <fstream>
#include <stdexcept>
#include <string>

#include "platform/files/input_error.hpp"
#include "tools/experiments/experiment.hpp"

namespace crspf::test {

using namespace crspf::experiments;

inline RgbImage checkers() {
    RgbImage image{.width = 4, .height = 3, .pixels = std::vector<Rgb>(12)};
    image.at(1, 2) = kPathColour;
    return image;
}

inline Findings find(const Context& context) {
    std::ofstream(context.scratch / "left behind") << "rubbish";
    context.progress(0.5);
    return {.blocks = {Paragraph{"5 < 6 & \"so on\""},
                       Table{.caption = "Cells", .head = {"a", "b"}, .rows = {{"1", "<b>2</b>"}}},
                       Chart{.caption = "A line",
                             .x_label = "t [s]",
                             .y_label = "m",
                             .series = {{.name = "x & y", .x = {0.0, 1.0}, .y = {1.0, 2.0}}},
                             .file = "line"},
                       Picture{.caption = "A map", .image = checkers(), .file = "map"}},
            .claims = {{.paper = "It is < 1 m", .measured = "0.5 m | 0.6 m", .verdict = Verdict::kHolds},
                       {.paper = "It never fails", .measured = "once", .verdict = Verdict::kDoesNotHold}},
            .headlines = {{.run = "the run", .result = std::to_string(context.seeds) + " seeds"}},
            .figures = {{"error_m", 0.5}}};
}

inline Findings skip(const Context& /*context*/) {
    throw Skipped("no <recording> here");
}

inline Findings fail(const Context& /*context*/) {
    throw InputError("map.yaml:3: wrong; mend it");
}

inline Findings crash(const Context& /*context*/) {
    throw std::logic_error("a bug");
}

inline constexpr std::array kFakes{
    Experiment{"found", "Something is found", "Fig. 1", 3, find},
    Experiment{"absent", "Nothing is there", "Fig. 2", 0, skip},
    Experiment{"failing", "It fails", "Fig. 3", 1, fail},
    Experiment{"crashing", "It crashes", "Fig. 4", 0, crash},
};

/// Of the first two.
inline Report sample_report() {
    const Context context{.data = {}, .maps = {}, .scratch = "/nonexistent", .seeds = 3, .progress = [](double) {}};
    Report report{.command = "crspf experiments --out 'a<b'",
                  .version = "1.2.3",
                  .compiler = "13",
                  .machine = "A&B processor",
                  .date = "2024-05-06T07:08:09Z",
                  .sections = {}};
    report.sections.push_back({.name = "found",
                               .title = "Something is found",
                               .source = "Fig. 1",
                               .seeds = "1 to 3",
                               .command = "crspf experiments found --out o",
                               .seconds = 1.5,
                               .findings = find(context)});
    report.sections.push_back({.name = "absent",
                               .title = "Nothing",
                               .source = "Fig. 2",
                               .seeds = "1, always",
                               .skipped = "no <recording> here"});
    return report;
}

}  // namespace crspf::test
