#include "tools/experiments/report/chart.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <utility>

#include "tools/experiments/report/axis.hpp"
#include "tools/experiments/report/curve.hpp"
#include "tools/experiments/report/markup.hpp"

namespace crspf::experiments {

namespace {

constexpr double kWidth_px = 900.0;
constexpr double kRight_px = 24.0;
constexpr double kBottom_px = 56.0;  // tick labels and the axis' name
constexpr double kLetter_px = 7.2;   // about, of 13 px
constexpr double kRow_px = 20.0;     // of the legend
constexpr double kSample_px = 34.0;  // of a line in the legend, with the room beside it
constexpr double kPlotHeight_px = 340.0;
constexpr double kPlanHeightMin_px = 140.0;
constexpr double kPlanHeightMax_px = 640.0;
constexpr std::size_t kMostPoints = 4000;  // of a series

// After Okabe and Ito, without their yellow, which is too light for a line on white.
constexpr std::array kColours{"#0072b2", "#d55e00", "#009e73", "#cc79a7", "#e69f00", "#56b4e9", "#444444"};

/// Axes, and where the plot lies in the picture.
struct Frame {
    Axis x;
    Axis y;
    double left_px = 0.0;
    double top_px = 0.0;
    double width_px = 0.0;
    double height_px = 0.0;

    [[nodiscard]] double x_px(double value) const { return left_px + width_px * x.share_of(value); }
    [[nodiscard]] double y_px(double value) const { return top_px + height_px * (1.0 - y.share_of(value)); }
};

template <class... Arguments>
void add(std::string& svg, fmt::format_string<Arguments...> format, Arguments&&... arguments) {
    fmt::format_to(std::back_inserter(svg), format, std::forward<Arguments>(arguments)...);
}

std::vector<Curve> curves_of(const Series& series, const Chart& chart, const Frame& frame) {
    std::vector<Curve> curves(1);
    for (std::size_t i = 0; i < std::min(series.x.size(), series.y.size()); ++i) {
        if (has_place(series.x[i], chart.log_x) && has_place(series.y[i], chart.log_y)) {
            curves.back().push_back({frame.x_px(series.x[i]), frame.y_px(series.y[i])});
        } else if (!curves.back().empty()) {
            curves.emplace_back();
        }
    }
    if (curves.back().empty()) {
        curves.pop_back();
    }
    return curves;
}

// Everything in x, and everything in y.
std::pair<Extent, Extent> extents_of(const Chart& chart) {
    Extent x;
    Extent y;
    for (const Series& series : chart.series) {
        for (std::size_t i = 0; i < std::min(series.x.size(), series.y.size()); ++i) {
            if (has_place(series.x[i], chart.log_x) && has_place(series.y[i], chart.log_y)) {
                x.add(series.x[i]);
                y.add(series.y[i]);
            }
        }
    }
    for (const Level& level : chart.levels) {
        if (has_place(level.y, chart.log_y)) {
            y.add(level.y);
        }
    }
    return {x, y};
}

int most_ticks(double length_px, double apart_px) {
    return std::max(2, static_cast<int>(length_px / apart_px));
}

std::vector<Tick> x_ticks(const Frame& frame) {
    constexpr double kApart_px = 80.0;
    return ticks_of(frame.x, most_ticks(frame.width_px, kApart_px));
}

std::vector<Tick> y_ticks(const Frame& frame) {
    constexpr double kApart_px = 40.0;
    return ticks_of(frame.y, most_ticks(frame.height_px, kApart_px));
}

void widen(Axis& axis, double span) {
    const double more = 0.5 * (span - (axis.high - axis.low));
    axis.low -= more;
    axis.high += more;
}

// The plot becomes as high as the plan demands, within bounds; then one axis spans more than it must.
void equalise(Frame& frame) {
    const double x_span = frame.x.high - frame.x.low;
    const double y_span = frame.y.high - frame.y.low;
    frame.height_px = std::clamp(frame.width_px * y_span / x_span, kPlanHeightMin_px, kPlanHeightMax_px);
    const double per_px = std::max(x_span / frame.width_px, y_span / frame.height_px);
    widen(frame.x, per_px * frame.width_px);
    widen(frame.y, per_px * frame.height_px);
}

Frame frame_of(const Chart& chart, double top_px) {
    constexpr double kAxisName_px = 34.0;
    const auto [x, y] = extents_of(chart);
    const bool plan = chart.equal_scales && !chart.log_x && !chart.log_y;
    Frame frame{.x = plan ? close_axis_of(x) : axis_of(x, chart.log_x),
                .y = plan ? close_axis_of(y) : axis_of(y, chart.log_y),
                .top_px = top_px,
                .height_px = kPlotHeight_px};
    std::size_t letters = 3;
    for (const Tick& tick : y_ticks(frame)) {
        letters = std::max(letters, tick.label.size() + (plan ? 1 : 0));  // equal scales may widen the axis
    }
    frame.left_px = kAxisName_px + kLetter_px * static_cast<double>(letters);
    frame.width_px = kWidth_px - frame.left_px - kRight_px;
    if (plan) {
        equalise(frame);
    }
    return frame;
}

void add_grid(std::string& svg, const Chart& chart, const Frame& frame) {
    const double right_px = frame.left_px + frame.width_px;
    const double bottom_px = frame.top_px + frame.height_px;
    std::string lines;
    std::string labels;
    for (const Tick& tick : x_ticks(frame)) {
        const double x_px = frame.x_px(tick.value);
        add(lines, "M{0:.1f} {1:.1f}V{2:.1f}", x_px, frame.top_px, bottom_px);
        add(labels, R"(<text x="{:.1f}" y="{:.1f}" text-anchor="middle">{}</text>)", x_px, bottom_px + 18.0,
            tick.label);
    }
    for (const Tick& tick : y_ticks(frame)) {
        const double y_px = frame.y_px(tick.value);
        add(lines, "M{:.1f} {:.1f}H{:.1f}", frame.left_px, y_px, right_px);
        add(labels, R"(<text x="{:.1f}" y="{:.1f}" text-anchor="end">{}</text>)", frame.left_px - 7.0, y_px + 4.5,
            tick.label);
    }
    add(svg, "<path d=\"{}\" stroke=\"#e3e3e3\" fill=\"none\"/>\n", lines);
    add(svg, "<rect x=\"{:.1f}\" y=\"{:.1f}\" width=\"{:.1f}\" height=\"{:.1f}\" fill=\"none\" stroke=\"#888888\"/>\n",
        frame.left_px, frame.top_px, frame.width_px, frame.height_px);
    add(svg, "<g fill=\"#333333\">{}\n", labels);
    add(svg, "<text x=\"{:.1f}\" y=\"{:.1f}\" text-anchor=\"middle\">{}</text>\n", frame.left_px + 0.5 * frame.width_px,
        bottom_px + 42.0, escaped(chart.x_label));
    const double middle_px = frame.top_px + 0.5 * frame.height_px;
    add(svg,
        "<text x=\"12\" y=\"{0:.1f}\" text-anchor=\"middle\" transform=\"rotate(-90 12 {0:.1f})\">{1}</text></g>\n",
        middle_px, escaped(chart.y_label));
}

/// The colours come again, dashed.
struct Look {
    const char* colour;
    const char* dashes;
};

Look look_of(std::size_t index) {
    return {kColours[index % kColours.size()], index < kColours.size() ? "none" : "7 4"};
}

void add_series(std::string& svg, const Series& series, const Look& look, const std::vector<Curve>& curves) {
    constexpr std::size_t kFew = 100;  // dots, which are seen the better for being large
    constexpr double kLine_px = 1.8;
    const bool dots = series.mark == Mark::kDots;
    std::size_t points = 0;
    for (const Curve& curve : curves) {
        points += curve.size();
    }
    std::string path;
    Curve all_dots;
    for (const Curve& curve : curves) {
        if (dots) {
            all_dots.insert(all_dots.end(), curve.begin(), curve.end());
            continue;
        }
        const Curve drawn = series.mark == Mark::kSteps ? stepped(curve) : curve;
        path += line_path(points > kMostPoints ? thinned(drawn, kMostPoints * curve.size() / points) : drawn);
    }
    if (dots) {
        path = dots_path(thinned_dots(all_dots, kMostPoints));
    }
    if (!path.empty()) {
        add(svg,
            "<path d=\"{}\" fill=\"none\" stroke=\"{}\" stroke-width=\"{}\" stroke-linecap=\"round\" "
            "stroke-linejoin=\"round\" stroke-dasharray=\"{}\"/>\n",
            path, look.colour, dots ? (points <= kFew ? 6.0 : 3.5) : kLine_px, dots ? "none" : look.dashes);
    }
}

// Labels of levels that lie close together stand below each other.
void add_levels(std::string& svg, const Chart& chart, const Frame& frame) {
    constexpr double kApart_px = 15.0;
    std::vector<Level> levels = chart.levels;
    std::erase_if(levels, [&](const Level& level) { return !has_place(level.y, chart.log_y); });
    std::sort(levels.begin(), levels.end(), [](const Level& a, const Level& b) { return a.y > b.y; });
    const double right_px = frame.left_px + frame.width_px;
    double text_px = frame.top_px;
    for (const Level& level : levels) {
        const double y_px = frame.y_px(level.y);
        text_px = std::max(y_px - 5.0, text_px + kApart_px);
        add(svg, "<path d=\"M{:.1f} {:.1f}H{:.1f}\" stroke=\"#222222\" stroke-dasharray=\"2 3\" fill=\"none\"/>\n",
            frame.left_px, y_px, right_px);
        add(svg,
            "<text x=\"{:.1f}\" y=\"{:.1f}\" text-anchor=\"end\" fill=\"#222222\" stroke=\"#ffffff\" "
            "stroke-width=\"4\" "
            "paint-order=\"stroke\">{}</text>\n",
            right_px - 6.0, text_px, escaped(level.name));
    }
}

/// A name beside a sample of its line. Series without a name have none.
struct LegendEntry {
    std::size_t series = 0;
    double x_px = 0.0;
    double y_px = 0.0;
};

std::vector<LegendEntry> legend_of(const Chart& chart) {
    constexpr double kLeft_px = 16.0;
    std::vector<LegendEntry> entries;
    LegendEntry next{.x_px = kLeft_px, .y_px = kRow_px};
    for (next.series = 0; next.series < chart.series.size(); ++next.series) {
        const std::string& name = chart.series[next.series].name;
        if (name.empty()) {
            continue;
        }
        const double width_px = kSample_px + kLetter_px * static_cast<double>(length_of(name)) + 18.0;
        if (next.x_px > kLeft_px && next.x_px + width_px > kWidth_px) {
            next.x_px = kLeft_px;
            next.y_px += kRow_px;
        }
        entries.push_back(next);
        next.x_px += width_px;
    }
    return entries;
}

void add_legend(std::string& svg, const Chart& chart, const std::vector<LegendEntry>& entries) {
    for (const LegendEntry& entry : entries) {
        const Series& series = chart.series[entry.series];
        const Look look = look_of(entry.series);
        const double middle_px = entry.y_px - 4.5;
        if (series.mark == Mark::kDots) {
            add(svg, R"(<circle cx="{:.1f}" cy="{:.1f}" r="3.5" fill="{}"/>)", entry.x_px + 13.0, middle_px,
                look.colour);
        } else {
            add(svg,
                R"(<path d="M{:.1f} {:.1f}h26" stroke="{}" stroke-width="2.5" stroke-dasharray="{}" fill="none"/>)",
                entry.x_px, middle_px, look.colour, look.dashes);
        }
        add(svg, "<text x=\"{:.1f}\" y=\"{:.1f}\" fill=\"#222222\">{}</text>\n", entry.x_px + kSample_px, entry.y_px,
            escaped(series.name));
    }
}

}  // namespace

std::string svg_of(const Chart& chart) {
    constexpr double kAboveLegend_px = 12.0;
    const std::vector<LegendEntry> legend = legend_of(chart);
    const Frame frame = frame_of(chart, kAboveLegend_px + (legend.empty() ? 0.0 : legend.back().y_px));
    const double height_px = frame.top_px + frame.height_px + kBottom_px;
    std::string svg;
    add(svg,
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{0:.0f}\" height=\"{1:.0f}\" viewBox=\"0 0 {0:.0f} "
        "{1:.0f}\" "
        "role=\"img\" font-family=\"sans-serif\" font-size=\"13\">\n<title>{2}</title>\n"
        "<rect width=\"{0:.0f}\" height=\"{1:.0f}\" fill=\"#ffffff\"/>\n",
        kWidth_px, height_px, escaped(chart.caption));
    add_grid(svg, chart, frame);
    bool drawn = false;
    for (std::size_t i = 0; i < chart.series.size(); ++i) {
        const std::vector<Curve> curves = curves_of(chart.series[i], chart, frame);
        drawn = drawn || !curves.empty();
        add_series(svg, chart.series[i], look_of(i), curves);
    }
    if (!drawn) {
        add(svg, "<text x=\"{:.1f}\" y=\"{:.1f}\" text-anchor=\"middle\" fill=\"#777777\">nothing to draw</text>\n",
            frame.left_px + 0.5 * frame.width_px, frame.top_px + 0.5 * frame.height_px);
    }
    add_levels(svg, chart, frame);
    add_legend(svg, chart, legend);
    return svg + "</svg>\n";
}

}  // namespace crspf::experiments
