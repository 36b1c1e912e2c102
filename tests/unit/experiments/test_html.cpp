#include <catch2/catch.hpp>
#include <regex>
#include <string>

#include "tests/unit/experiments/fakes.hpp"
#include "tools/experiments/report/html.hpp"

using crspf::experiments::html_of;
using crspf::test::sample_report;

namespace {

bool has(const std::string& html, const std::string& text) {
    return html.find(text) != std::string::npos;
}

}  // namespace

TEST_CASE("The report is one file: it refers to nothing but itself", "[experiments][html]") {
    const std::string html = html_of(sample_report());
    const std::regex reference(R"re((src|href|srcset|action|poster)\s*=\s*"([^"]*)"|url\(([^)]*)\)|@import)re");
    std::size_t references = 0;
    for (std::sregex_iterator found(html.begin(), html.end(), reference), end; found != end; ++found) {
        const std::string target = (*found)[2].str();
        CHECK((target.rfind('#', 0) == 0 || target.rfind("data:image/png;base64,", 0) == 0));
        ++references;
    }
    CHECK(references > 3);
    CHECK_FALSE(has(html, "<script"));
    CHECK_FALSE(has(html, "<link"));
}

TEST_CASE("What is told comes through as text", "[experiments][html]") {
    const std::string html = html_of(sample_report());
    CHECK(has(html, "5 &lt; 6 &amp; &quot;so on&quot;"));
    CHECK(has(html, "<td>&lt;b&gt;2&lt;/b&gt;</td>"));
    CHECK(has(html, "It is &lt; 1 m"));
    CHECK(has(html, "no &lt;recording&gt; here"));
    CHECK(has(html, "A&amp;B processor"));
    CHECK(has(html, "crspf experiments --out &#39;a&lt;b&#39;"));
}

TEST_CASE("The report tells how it was made, and each section how to make it again", "[experiments][html]") {
    const std::string html = html_of(sample_report());
    for (const char* text : {"1.2.3", "2024-05-06T07:08:09Z", "crspf experiments found --out o", "1 to 3", "1.5 s",
                             "Fig. 1", "1, always"}) {
        CHECK(has(html, text));
    }
}

TEST_CASE("The table of claims counts them and leads to their sections", "[experiments][html]") {
    const std::string html = html_of(sample_report());
    CHECK(has(html, "2 claims: 1 holds, 0 partly, 1 does not hold, 0 not measured"));
    CHECK(has(html, "<td><a href=\"#found\">found</a></td>"));
    CHECK(has(html, "<h2 id=\"found\">"));
    CHECK(has(html, "not found yet"));  // the reason that is owed
}

TEST_CASE("A section that was skipped or failed says why", "[experiments][html]") {
    crspf::experiments::Report report = sample_report();
    CHECK(has(html_of(report), "<strong>Skipped:</strong> no &lt;recording&gt; here"));
    report.sections[1].skipped.clear();
    report.sections[1].failure = "map.yaml: wrong";
    CHECK(has(html_of(report), "<strong>Failed:</strong> map.yaml: wrong"));
}

TEST_CASE("A report of nothing is a report", "[experiments][html]") {
    CHECK(has(html_of({}), "0 claims"));
}
