// What experiments report, before it has a form: html.hpp, json.hpp and markdown.hpp give it one.
#pragma once

#include <cstdint>
#include <nlohmann/json.hpp>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "platform/files/png_image.hpp"

namespace crspf::experiments {

/// Text without markup.
struct Paragraph {
    std::string text;
};

struct Table {
    std::string caption;
    std::vector<std::string> head;
    std::vector<std::vector<std::string>> rows;  ///< each as long as the head
};

enum class Mark : std::uint8_t { kLine, kSteps, kDots };

struct Series {
    std::string name;
    std::vector<double> x = {};
    std::vector<double> y = {};  ///< as many; what is not finite is a gap
    Mark mark = Mark::kLine;
};

/// A line across the whole chart.
struct Level {
    std::string name;
    double y = 0.0;
};

struct Chart {
    std::string caption;
    std::string x_label;
    std::string y_label;
    std::vector<Series> series = {};
    std::vector<Level> levels = {};
    bool log_x = false;
    bool log_y = false;
    bool equal_scales = false;  ///< a metre is as long in x as in y: a plan
    std::string file = {};      ///< not empty: DIR/FILE.svg is written, too
};

/// A map or another picture of pixels.
struct Picture {
    std::string caption;
    RgbImage image;
    std::string file = {};  ///< not empty: DIR/FILE.png is written, too
};

using Block = std::variant<Paragraph, Table, Chart, Picture>;

enum class Verdict : std::uint8_t { kHolds, kPartly, kDoesNotHold, kNotMeasured };

/// What the paper says, beside what was measured.
struct Claim {
    std::string paper;
    std::string measured;
    Verdict verdict = Verdict::kNotMeasured;
    std::string reason = {};  ///< why it does not hold, or only partly
};

/// A row of the README's table.
struct Headline {
    std::string run;
    std::string result;
};

/// What one experiment found.
struct Findings {
    std::vector<Block> blocks = {};
    std::vector<Claim> claims = {};
    std::vector<Headline> headlines = {};
    nlohmann::ordered_json figures = nlohmann::ordered_json::object();  ///< every number that is told, by name
};

/// Findings, and what is needed to find the same again.
struct Section {
    std::string name;        ///< as on the command line
    std::string title;       ///< what is done, in a line
    std::string source;      ///< where in the paper
    std::string seeds = {};  ///< "1 to 10"
    std::string command = {};
    double seconds = 0.0;      ///< that it took
    std::string skipped = {};  ///< not empty: why nothing was found
    std::string failure = {};  ///< not empty: what went wrong
    Findings findings = {};
};

struct Report {
    std::string command;
    std::string version;
    std::string compiler;
    std::string machine;
    std::string date;  ///< ISO 8601, UTC
    std::vector<Section> sections = {};
};

}  // namespace crspf::experiments
