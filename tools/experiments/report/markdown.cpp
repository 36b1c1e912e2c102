#include "tools/experiments/report/markdown.hpp"

#include <fmt/format.h>

#include <iterator>

#include "tools/experiments/report/markup.hpp"
#include "tools/experiments/report/verdicts.hpp"

namespace crspf::experiments {

namespace {

std::string origin_of(const Report& report) {
    return fmt::format("Made by `{}`: version {}, {}, {}, {}.\n\n", report.command, report.version, report.compiler,
                       report.machine, report.date);
}

}  // namespace

std::string headlines_of(const Report& report) {
    std::string text = origin_of(report) + "| run | result |\n|---|---|\n";
    for (const Section& section : report.sections) {
        for (const Headline& headline : section.findings.headlines) {
            fmt::format_to(std::back_inserter(text), "| {} | {} |\n", markdown_cell(headline.run),
                           markdown_cell(headline.result));
        }
    }
    return text;
}

std::string claims_of(const Report& report) {
    std::string text = origin_of(report);
    fmt::format_to(std::back_inserter(text), "{}.\n\n", text_of(tally_of(report.sections)));
    text += "| experiment | the paper says | measured | verdict | reason |\n|---|---|---|---|---|\n";
    for (const Section& section : report.sections) {
        for (const Claim& claim : section.findings.claims) {
            fmt::format_to(std::back_inserter(text), "| {} | {} | {} | {} | {} |\n", markdown_cell(section.name),
                           markdown_cell(claim.paper), markdown_cell(claim.measured), name_of(claim.verdict),
                           markdown_cell(reason_of(claim)));
        }
    }
    return text;
}

}  // namespace crspf::experiments
