// A report with one of each block, for the browser to look at. usage: sample_report FILE.html
#include <cmath>
#include <cstdio>
#include <fstream>
#include <limits>

#include "tools/experiments/report/html.hpp"

namespace {

using namespace crspf::experiments;

Chart waves() {
    Chart chart{
        .caption = "Values over time, with a gap",
        .x_label = "time [s]",
        .y_label = "value <&>",
        .series = {{.name = "line"}, {.name = "steps", .mark = Mark::kSteps}, {.name = "dots", .mark = Mark::kDots}},
        .levels = {{.name = "a level", .y = 1.2}, {.name = "another, close to it", .y = 1.15}}};
    for (int i = 0; i < 200; ++i) {
        const double t = 0.1 * i;
        for (Series& series : chart.series) {
            series.x.push_back(t);
        }
        chart.series[0].y.push_back(i > 90 && i < 110 ? std::numeric_limits<double>::quiet_NaN() : std::sin(t));
        chart.series[1].y.push_back(std::round(2.0 * std::cos(0.3 * t)) / 2.0);
        chart.series[2].y.push_back(0.5 * std::sin(2.0 * t));
    }
    return chart;
}

Chart growth() {
    return {.caption = "Growth on log axes",
            .x_label = "map [m^2]",
            .y_label = "time [ms]",
            .series = {{.name = "measured", .x = {10.0, 100.0, 1e4, 1e6}, .y = {0.1, 0.12, 0.13, 0.4}},
                       {.name = "0 has no place", .x = {0.0, 1e5}, .y = {0.0, 3.0}, .mark = Mark::kDots}},
            .log_x = true,
            .log_y = true};
}

Chart plan() {
    return {.caption = "A plan, a metre as long in x as in y",
            .x_label = "x [m]",
            .y_label = "y [m]",
            .series = {{.name = "room", .x = {0.0, 30.0, 30.0, 0.0, 0.0}, .y = {0.0, 0.0, 10.0, 10.0, 0.0}}},
            .equal_scales = true};
}

crspf::RgbImage picture() {
    constexpr int kWidth = 120;
    constexpr int kHeight = 80;
    crspf::RgbImage image{
        .width = kWidth, .height = kHeight, .pixels = std::vector<crspf::Rgb>(std::size_t{kWidth} * kHeight)};
    for (int x = 0; x < kWidth; ++x) {
        for (int y = 0; y < kHeight; ++y) {
            image.at(x, y) = (x / 10 + y / 10) % 2 == 0 ? crspf::kFreeColour : crspf::kPathColour;
        }
    }
    return image;
}

Report sample() {
    Section full{.name = "sample",
                 .title = "One of each",
                 .source = "Fig. 0",
                 .seeds = "1 to 3",
                 .command = "crspf experiments sample --out report",
                 .seconds = 83.0};
    full.findings.blocks = {Paragraph{"A paragraph, with 1 < 2 & more."},
                            Table{.caption = "A table", .head = {"x", "y"}, .rows = {{"1", "2"}, {"3", "4"}}},
                            waves(),
                            growth(),
                            plan(),
                            Picture{.caption = "A picture", .image = picture()}};
    full.findings.claims = {
        {.paper = "The error is below 1 m.", .measured = "0.3 m", .verdict = Verdict::kHolds},
        {.paper = "It is twice as fast.", .measured = "1.5 times", .verdict = Verdict::kPartly, .reason = "Memory."},
        {.paper = "It never fails.", .measured = "2 of 10", .verdict = Verdict::kDoesNotHold, .reason = "Mirrors."},
        {.paper = "It works on the moon.", .measured = "-", .verdict = Verdict::kNotMeasured}};
    full.findings.headlines = {{.run = "a run", .result = "0.3 m"}};
    const Section absent{.name = "absent", .title = "Not there", .source = "Fig. 1", .skipped = "no recording"};
    return {.command = "crspf experiments --out report",
            .version = "0",
            .compiler = "none",
            .machine = "any",
            .date = "2024-01-01T00:00:00Z",
            .sections = {full, absent}};
}

}  // namespace

int main(int argc, char** argv) {
    if (argc != 2) {
        std::fputs("usage: sample_report FILE.html\n", stderr);
        return 2;
    }
    std::ofstream file(argv[1]);
    file << html_of(sample());
    return file.flush() ? 0 : 1;
}
