#include "tools/experiments/report/json.hpp"

#include "tools/experiments/report/verdicts.hpp"

namespace crspf::experiments {

namespace {

using Json = nlohmann::ordered_json;

constexpr int kSchema = 1;

Json text_or_null(const std::string& text) {
    return text.empty() ? Json(nullptr) : Json(text);
}

Json json_of(const Section& section) {
    Json claims = Json::array();
    for (const Claim& claim : section.findings.claims) {
        claims.push_back({{"paper", claim.paper},
                          {"measured", claim.measured},
                          {"verdict", name_of(claim.verdict)},
                          {"reason", text_or_null(reason_of(claim))}});
    }
    Json headlines = Json::array();
    for (const Headline& headline : section.findings.headlines) {
        headlines.push_back({{"run", headline.run}, {"result", headline.result}});
    }
    Json tables = Json::array();
    for (const Block& block : section.findings.blocks) {
        if (const auto* table = std::get_if<Table>(&block)) {
            tables.push_back({{"caption", table->caption}, {"head", table->head}, {"rows", table->rows}});
        }
    }
    return {{"name", section.name},
            {"title", section.title},
            {"source", section.source},
            {"command", section.command},
            {"seeds", section.seeds},
            {"seconds", section.seconds},
            {"skipped", text_or_null(section.skipped)},
            {"failure", text_or_null(section.failure)},
            {"figures", section.findings.figures},
            {"claims", claims},
            {"headlines", headlines},
            {"tables", tables}};
}

}  // namespace

nlohmann::ordered_json json_of(const Report& report) {
    const Tally tally = tally_of(report.sections);
    Json sections = Json::array();
    for (const Section& section : report.sections) {
        sections.push_back(json_of(section));
    }
    return {{"schema", kSchema},
            {"command", report.command},
            {"version", report.version},
            {"compiler", report.compiler},
            {"machine", report.machine},
            {"date", report.date},
            {"claims",
             {{"holds", tally.holds},
              {"partly", tally.partly},
              {"does not hold", tally.does_not_hold},
              {"not measured", tally.not_measured}}},
            {"experiments", sections}};
}

}  // namespace crspf::experiments
