#include <algorithm>
#include <catch2/catch.hpp>
#include <iterator>
#include <limits>
#include <pugixml.hpp>
#include <sstream>
#include <string>
#include <vector>

#include "tools/experiments/report/chart.hpp"

using crspf::experiments::Chart;
using crspf::experiments::Mark;
using crspf::experiments::svg_of;

namespace {

constexpr double kNothing = std::numeric_limits<double>::quiet_NaN();
constexpr const char* kBlue = "#0072b2";  // of the first series

// As another parser reads it.
pugi::xml_document parsed(const Chart& chart) {
    pugi::xml_document document;
    const std::string svg = svg_of(chart);
    INFO(svg);
    REQUIRE(document.load_string(svg.c_str()));
    REQUIRE(std::string(document.first_child().name()) == "svg");
    REQUIRE(document.first_child().next_sibling().empty());
    CHECK(svg.find("nan") == std::string::npos);
    CHECK(svg.find("inf") == std::string::npos);
    return document;
}

bool has_text(const pugi::xml_document& document, const std::string& text) {
    return !document.find_node([&](const pugi::xml_node& node) { return text == node.child_value(); }).empty();
}

std::string first_path(const pugi::xml_document& document) {
    return document
        .find_node([](const pugi::xml_node& node) { return std::string(kBlue) == node.attribute("stroke").value(); })
        .attribute("d")
        .value();
}

Chart line(std::vector<double> x, std::vector<double> y) {
    return {.caption = "c",
            .x_label = "x [s]",
            .y_label = "y [m]",
            .series = {{.name = {}, .x = std::move(x), .y = std::move(y)}}};
}

}  // namespace

TEST_CASE("A chart shows its labels, its legend, its levels and its ticks", "[experiments][chart]") {
    Chart chart = line({0.0, 10.0}, {0.0, 5.0});
    chart.series[0].name = "error";
    chart.levels = {{.name = "the paper's 3 m", .y = 3.0}};
    const pugi::xml_document document = parsed(chart);
    for (const char* text : {"x [s]", "y [m]", "error", "the paper's 3 m", "10", "5"}) {
        CHECK(has_text(document, text));
    }
    CHECK(document.first_child().attribute("width").as_int() == 900);
}

TEST_CASE("Text in a chart is text, whatever it holds", "[experiments][chart]") {
    const std::string wild = "<script>\"a\" & 'b'</script>";
    Chart chart = line({0.0, 1.0}, {0.0, 1.0});
    chart.caption = chart.x_label = chart.y_label = chart.series[0].name = wild;
    chart.levels = {{.name = wild, .y = 0.5}};
    const pugi::xml_document document = parsed(chart);
    CHECK(has_text(document, wild));
    CHECK(document.find_node([](const pugi::xml_node& n) { return std::string(n.name()) == "script"; }).empty());
}

TEST_CASE("What is not finite is a gap in a line", "[experiments][chart]") {
    const std::string whole = first_path(parsed(line({0.0, 1.0, 2.0, 3.0}, {1.0, 2.0, 3.0, 4.0})));
    const std::string broken = first_path(parsed(line({0.0, 1.0, kNothing, 2.0, 3.0}, {1.0, 2.0, 7.0, 3.0, 4.0})));
    CHECK(std::count(whole.begin(), whole.end(), 'M') == 1);
    CHECK(std::count(broken.begin(), broken.end(), 'M') == 2);
}

TEST_CASE("Steps and dots are drawn as such", "[experiments][chart]") {
    Chart chart = line({0.0, 1.0, 2.0}, {1.0, 2.0, 3.0});
    chart.series[0].mark = Mark::kSteps;
    const std::string steps = first_path(parsed(chart));
    CHECK(std::count(steps.begin(), steps.end(), 'L') == 4);
    chart.series[0].mark = Mark::kDots;
    const std::string dots = first_path(parsed(chart));
    CHECK(std::count(dots.begin(), dots.end(), 'M') == 3);
}

TEST_CASE("A chart of nothing says so", "[experiments][chart]") {
    for (const bool log : {false, true}) {
        for (const bool plan : {false, true}) {
            for (Chart chart : {Chart{}, line({}, {}), line({kNothing}, {kNothing}), line({1.0}, {}),
                                line({1e300, -1e300}, {1e300, -1e300})}) {
                chart.log_x = chart.log_y = log;
                chart.equal_scales = plan;
                CHECK(has_text(parsed(chart), "nothing to draw"));
            }
        }
    }
}

TEST_CASE("One point, a constant and a log axis with values at or below zero are charts", "[experiments][chart]") {
    for (Chart chart : {line({1.0}, {2.0}), line({1.0, 2.0}, {5.0, 5.0}), line({1.0, 2.0, 3.0}, {0.0, -4.0, 4.0})}) {
        for (const bool log : {false, true}) {
            chart.log_x = chart.log_y = log;
            const pugi::xml_document document = parsed(chart);
            CHECK_FALSE(first_path(document).empty());
            CHECK_FALSE(has_text(document, "nothing to draw"));
        }
    }
}

TEST_CASE("A level without a place on a log axis is left out", "[experiments][chart]") {
    Chart chart = line({1.0, 2.0}, {1.0, 2.0});
    chart.log_y = true;
    chart.levels = {{.name = "zero", .y = 0.0}, {.name = "one", .y = 1.0}};
    const pugi::xml_document document = parsed(chart);
    CHECK_FALSE(has_text(document, "zero"));
    CHECK(has_text(document, "one"));
}

TEST_CASE("In a plan a metre is as long in x as in y", "[experiments][chart]") {
    for (const double side : {0.5, 4.0, 300.0}) {
        Chart plan = line({0.0, 10.0, 10.0}, {0.0, 0.0, side});
        plan.equal_scales = true;
        std::string path = first_path(parsed(plan));
        std::replace_if(
            path.begin(), path.end(), [](char c) { return c == 'M' || c == 'L'; }, ' ');
        std::istringstream numbers(path);
        const std::vector<double> px{std::istream_iterator<double>(numbers), std::istream_iterator<double>()};
        REQUIRE(px.size() == 6);  // x and y of three points
        CHECK((px[2] - px[0]) / 10.0 == Approx((px[3] - px[5]) / side).epsilon(0.02));
        CHECK(px[0] > 0.0);
        CHECK(px[2] < 900.0);
        CHECK(px[5] > 0.0);
    }
}

TEST_CASE("A line of very many points is a small file", "[experiments][chart]") {
    std::vector<double> x;
    std::vector<double> y;
    for (int i = 0; i < 500000; ++i) {
        x.push_back(i);
        y.push_back((i % 1000 * 919) % 1000);
    }
    for (const Mark mark : {Mark::kLine, Mark::kSteps, Mark::kDots}) {
        Chart chart = line(x, y);
        chart.series[0].mark = mark;
        CHECK(svg_of(chart).size() < 100000);
    }
}
