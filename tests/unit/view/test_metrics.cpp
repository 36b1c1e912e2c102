#include <algorithm>
#include <catch2/catch.hpp>
#include <regex>
#include <set>
#include <sstream>
#include <string>

#include "tools/view/metrics.hpp"

namespace {

using namespace crspf::view;

const char* const kStatus = R"({
  "uptime_s": 12.5,
  "pose": {"x_m": 1.5, "lost": true, "M": 2000, "age_ms": 40},
  "filter": {"scans": 100, "skipped": 3},
  "map": {"tiles": 7, "problem": "disk full"},
  "threads": [{"name": "filter", "median_below_us": 500, "p999_below_us": 2000, "max_us": 3000, "deadline_us": 20000,
               "misses": 2, "alive": true}],
  "sources": [{"name": "li\"dar\\\n", "state": "stale", "samples": 9, "age_ms": null, "counts": {"bad": 4}}],
  "odd": [1, {"x": "y"}]
})";

MetricsInput input_of(const char* status) {
    MetricsInput input;
    input.up = true;
    input.status = nlohmann::ordered_json::parse(status);
    input.web.peers = 2;
    input.hub.messages = 123456789;
    return input;
}

bool has_line(const std::string& text, const std::string& line) {
    return ("\n" + text).find("\n" + line + "\n") != std::string::npos;
}

TEST_CASE("What the service says is told in units of Prometheus", "[metrics]") {
    const std::string text = metrics_text(input_of(kStatus));
    CHECK(has_line(text, "crspf_up 1"));
    CHECK(has_line(text, "crspf_uptime_seconds 12.5"));
    CHECK(has_line(text, "crspf_pose_lost 1"));
    CHECK(has_line(text, "crspf_pose_age_seconds 0.04"));
    CHECK(has_line(text, "crspf_match_value 2000"));
    CHECK(has_line(text, "crspf_scans_total 100"));
    CHECK(has_line(text, "crspf_map_problem 1"));
    CHECK(has_line(text, "crspf_thread_latency_seconds{thread=\"filter\",quantile=\"0.999\"} 0.002"));
    CHECK(has_line(text, "crspf_thread_misses_total{thread=\"filter\"} 2"));
    CHECK(has_line(text, "crspf_view_peers 2"));
    CHECK(has_line(text, "crspf_view_messages_total 123456789"));
}

TEST_CASE("A source has one state, and names are escaped", "[metrics]") {
    const std::string text = metrics_text(input_of(kStatus));
    CHECK(has_line(text, R"(crspf_source_state{source="li\"dar\\\n",state="stale"} 1)"));
    CHECK(has_line(text, R"(crspf_source_state{source="li\"dar\\\n",state="ok"} 0)"));
    CHECK(has_line(text, R"(crspf_source_events_total{source="li\"dar\\\n",event="bad"} 4)"));
    CHECK(text.find("crspf_source_age_seconds{") == std::string::npos);  // there was no sample
}

TEST_CASE("Every line is one of the format's, and every metric is explained once, before its samples", "[metrics]") {
    const std::string text = metrics_text(input_of(kStatus));
    const std::regex sample(R"re(([a-z_]+)(\{[a-z]+="([^"\\]|\\.)*"(,[a-z]+="([^"\\]|\\.)*")*\})? [-+.e0-9]+)re");
    const std::regex about(R"re(# (HELP|TYPE) ([a-z_]+) .+)re");
    std::set<std::string> explained;
    std::string metric;
    std::istringstream lines(text);
    for (std::string line; std::getline(lines, line);) {
        CAPTURE(line);
        std::smatch match;
        if (std::regex_match(line, match, about)) {
            metric = match[2];
            CHECK(explained.insert(match[1].str() + metric).second);
        } else {
            REQUIRE(std::regex_match(line, match, sample));
            CHECK(match[1] == metric);
        }
    }
    CHECK(explained.size() > 40);
    CHECK(text.back() == '\n');
}

TEST_CASE("Of a service that is away nothing old is told", "[metrics]") {
    MetricsInput input = input_of(kStatus);
    input.up = false;
    const std::string text = metrics_text(input);
    CHECK(has_line(text, "crspf_up 0"));
    CHECK(text.find("crspf_pose") == std::string::npos);
    CHECK(has_line(text, "crspf_view_peers 2"));
}

TEST_CASE("A robot without a bus has none that is down", "[metrics]") {
    const std::string without = metrics_text(input_of(R"({"output": {"interface": "", "bus_open": false}})"));
    CHECK(without.find("crspf_output_bus_open") == std::string::npos);
    const std::string with = metrics_text(input_of(R"({"output": {"interface": "can0", "bus_open": false}})"));
    CHECK(has_line(with, "crspf_output_bus_open 0"));
}

TEST_CASE("A status of another shape is no error", "[metrics]") {
    const char* const status =
        GENERATE("null", "[]", "{}", R"({"pose": 7, "threads": {"a": 1}, "sources": [7, null, {}]})");
    CAPTURE(status);
    CHECK(has_line(metrics_text(input_of(status)), "crspf_up 1"));
}

}  // namespace
