#include "tools/experiments/report/html.hpp"

#include <fmt/format.h>

#include <cstdint>
#include <iterator>
#include <string_view>
#include <utility>

#include "platform/files/base64.hpp"
#include "tools/experiments/report/chart.hpp"
#include "tools/experiments/report/markup.hpp"
#include "tools/experiments/report/verdicts.hpp"

namespace crspf::experiments {

namespace {

// Wide things scroll within themselves on a phone; there claims are shown one below the other.
constexpr std::string_view kStyle = R"(
body{margin:0;background:#fff;color:#1a1a1a;font:16px/1.5 sans-serif}
main{max-width:60rem;margin:0 auto;padding:1rem}
h1{font-size:1.6rem;line-height:1.2}
h2{font-size:1.3rem;line-height:1.2;margin-top:2.5rem;border-top:1px solid #ccc;padding-top:1rem}
dl{display:grid;grid-template-columns:max-content 1fr;gap:.1rem 1rem;margin:1rem 0;font-size:.9rem}
dt{color:#555}dd{margin:0;overflow-wrap:anywhere}
code{font-family:monospace;overflow-wrap:anywhere}
figure{margin:1.2rem 0}
figcaption,caption{text-align:left;font-size:.9rem;color:#333;padding-bottom:.3rem}
.wide{overflow-x:auto}
svg{display:block;width:100%;min-width:36rem;height:auto}
img{display:block;max-width:100%;height:auto;border:1px solid #ccc}
table{border-collapse:collapse;font-size:.9rem}
th,td{text-align:left;vertical-align:top;padding:.25rem .6rem;border:1px solid #ccc}
th{background:#f2f2f2}
.holds,.partly,.fails,.open{font-weight:bold;white-space:nowrap}
.holds{color:#00664b}.partly{color:#8a5a00}.fails{color:#b03a00}.open{color:#555}
.absent{border-left:4px solid #8a5a00;padding-left:.8rem}
.failed{border-left:4px solid #b03a00;padding-left:.8rem}
@media(max-width:40rem){
.claims thead{display:none}
.claims,.claims tbody{display:block}
.claims tr{display:block;margin-bottom:.8rem;border:1px solid #ccc}
.claims td{display:block;border:0}
.claims td[data-name]::before{content:attr(data-name) ": ";color:#555;font-weight:normal}
}
@media print{main{max-width:none}svg{min-width:0}.wide{overflow:visible}figure,tr,dl{break-inside:avoid}}
)";

template <class... Arguments>
void append_html(std::string& html, fmt::format_string<Arguments...> format, Arguments&&... arguments) {
    fmt::format_to(std::back_inserter(html), format, std::forward<Arguments>(arguments)...);
}

// The sign tells it where colours are not seen.
std::string verdict_cell(Verdict verdict) {
    const char* kind = "";
    const char* sign = "";
    switch (verdict) {
        case Verdict::kHolds: kind = "holds", sign = "\u2714"; break;
        case Verdict::kPartly: kind = "partly", sign = "\u25D0"; break;
        case Verdict::kDoesNotHold: kind = "fails", sign = "\u2718"; break;
        case Verdict::kNotMeasured: kind = "open", sign = "\u2013"; break;
    }
    return fmt::format(R"(<td class="{}">{}&nbsp;{}</td>)", kind, sign, name_of(verdict));
}

std::string command_html(const std::string& command) {
    return "<code>" + escaped(command) + "</code>";
}

/// `where` links to the section; nothing where the table stands in it.
void append_claim(std::string& html, const Claim& claim, const std::string& where) {
    append_html(html, "<tr>");
    if (!where.empty()) {
        append_html(html, R"(<td><a href="#{0}">{0}</a></td>)", escaped(where));
    }
    append_html(html, R"(<td data-name="The paper">{}</td><td data-name="Measured">{}</td>{})", escaped(claim.paper),
                escaped(claim.measured), verdict_cell(claim.verdict));
    const std::string reason = reason_of(claim);
    append_html(html, "{}{}</td></tr>\n", reason.empty() ? "<td>" : R"(<td data-name="Reason">)", escaped(reason));
}

constexpr std::string_view kClaimHead =
    "<th>The paper says</th><th>Measured here</th><th>Verdict</th><th>Reason</th></tr></thead>\n<tbody>\n";

void append_all_claims(std::string& html, const Report& report) {
    append_html(html, "<h2 id=\"claims\">The paper's claims</h2>\n<p>{}.</p>\n", text_of(tally_of(report.sections)));
    append_html(html, "<div class=\"wide\"><table class=\"claims\">\n<thead><tr><th>Experiment</th>{}", kClaimHead);
    for (const Section& section : report.sections) {
        for (const Claim& claim : section.findings.claims) {
            append_claim(html, claim, section.name);
        }
    }
    append_html(html, "</tbody></table></div>\n");
}

void append_table(std::string& html, const Table& table) {
    append_html(html, "<figure class=\"wide\"><table>\n<caption>{}</caption>\n<thead><tr>", escaped(table.caption));
    for (const std::string& cell : table.head) {
        append_html(html, "<th>{}</th>", escaped(cell));
    }
    append_html(html, "</tr></thead>\n<tbody>\n");
    for (const std::vector<std::string>& row : table.rows) {
        append_html(html, "<tr>");
        for (const std::string& cell : row) {
            append_html(html, "<td>{}</td>", escaped(cell));
        }
        append_html(html, "</tr>\n");
    }
    append_html(html, "</tbody></table></figure>\n");
}

void append_headlines(std::string& html, const Report& report) {
    Table table{.caption = {}, .head = {"Run", "Result"}, .rows = {}};
    for (const Section& section : report.sections) {
        for (const Headline& headline : section.findings.headlines) {
            table.rows.push_back({headline.run, headline.result});
        }
    }
    if (!table.rows.empty()) {
        append_html(html, "<h2 id=\"headlines\">In short</h2>\n");
        append_table(html, table);
    }
}

/// One for each kind of block.
struct BlockHtml {
    std::string& html;

    void operator()(const Paragraph& paragraph) const { append_html(html, "<p>{}</p>\n", escaped(paragraph.text)); }
    void operator()(const Table& table) const { append_table(html, table); }
    void operator()(const Chart& chart) const {
        append_html(html, "<figure><figcaption>{}</figcaption><div class=\"wide\">\n{}</div></figure>\n",
                    escaped(chart.caption), svg_of(chart));
    }
    void operator()(const Picture& picture) const {
        append_html(html,
                    "<figure><figcaption>{0}</figcaption><img alt=\"{0}\" width=\"{1}\" height=\"{2}\" "
                    "src=\"data:image/png;base64,{3}\"></figure>\n",
                    escaped(picture.caption), picture.image.width, picture.image.height,
                    to_base64(encode_png(picture.image)));
    }
};

void append_section(std::string& html, const Section& section) {
    append_html(html, "<section>\n<h2 id=\"{}\">{}</h2>\n<dl>", escaped(section.name), escaped(section.title));
    append_html(html, "<dt>In the paper</dt><dd>{}</dd><dt>Again by</dt><dd>{}</dd><dt>Seeds</dt><dd>{}</dd>",
                escaped(section.source), command_html(section.command), escaped(section.seeds));
    append_html(html, "<dt>Took</dt><dd>{}</dd></dl>\n", duration_text(section.seconds));
    if (!section.skipped.empty()) {
        append_html(html, "<p class=\"absent\"><strong>Skipped:</strong> {}</p>\n", escaped(section.skipped));
    }
    if (!section.failure.empty()) {
        append_html(html, "<p class=\"failed\"><strong>Failed:</strong> {}</p>\n", escaped(section.failure));
    }
    for (const Block& block : section.findings.blocks) {
        std::visit(BlockHtml{html}, block);
    }
    if (!section.findings.claims.empty()) {
        append_html(html, "<div class=\"wide\"><table class=\"claims\">\n<thead><tr>{}", kClaimHead);
        for (const Claim& claim : section.findings.claims) {
            append_claim(html, claim, "");
        }
        append_html(html, "</tbody></table></div>\n");
    }
    append_html(html, "</section>\n");
}

void append_contents(std::string& html, const Report& report) {
    append_html(html, "<h2 id=\"contents\">Contents</h2>\n<ol>\n");
    for (const Section& section : report.sections) {
        append_html(html, "<li><a href=\"#{0}\">{0}</a>: {1}", escaped(section.name), escaped(section.title));
        if (!section.skipped.empty()) {
            append_html(html, " (skipped)");
        }
        if (!section.failure.empty()) {
            append_html(html, " <strong>(failed)</strong>");
        }
        append_html(html, "</li>\n");
    }
    append_html(html, "</ol>\n");
}

}  // namespace

std::string html_of(const Report& report) {
    constexpr std::string_view kTitle = "CRSPF-SLAM: the paper's experiments, repeated";
    std::string html;
    append_html(html,
                "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n<meta name=\"viewport\" "
                "content=\"width=device-width, initial-scale=1\">\n<title>{0}</title>\n<style>{1}</style>\n</head>\n"
                "<body>\n<main>\n<h1>{0}</h1>\n",
                kTitle, kStyle);
    append_html(html,
                "<p>What \"Critical Rays Self-adaptive Particle Filtering SLAM\" claims, beside what this program "
                "measures. Every figure below was made by the command named here; equal seeds give equal figures, but "
                "for times and loads, which are the machine's.</p>\n");
    append_html(html,
                "<dl><dt>Command</dt><dd>{}</dd><dt>Version</dt><dd>{}</dd><dt>Compiler</dt><dd>{}</dd><dt>Machine</dt>"
                "<dd>{}</dd><dt>Date</dt><dd>{}</dd></dl>\n",
                command_html(report.command), escaped(report.version), escaped(report.compiler),
                escaped(report.machine), escaped(report.date));
    append_headlines(html, report);
    append_all_claims(html, report);
    append_contents(html, report);
    for (const Section& section : report.sections) {
        append_section(html, section);
    }
    return html + "</main>\n</body>\n</html>\n";
}

}  // namespace crspf::experiments
