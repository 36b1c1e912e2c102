#include <catch2/catch.hpp>

#include "tests/unit/experiments/fakes.hpp"
#include "tools/experiments/report/json.hpp"

using crspf::experiments::json_of;
using crspf::test::sample_report;

TEST_CASE("JSON has how the report was made, and what was found", "[experiments][json]") {
    const nlohmann::ordered_json json = json_of(sample_report());
    CHECK(json["schema"] == 1);
    CHECK(json["version"] == "1.2.3");
    CHECK(json["claims"]["does not hold"] == 1);
    REQUIRE(json["experiments"].size() == 2);
    const auto& found = json["experiments"][0];
    CHECK(found["name"] == "found");
    CHECK(found["seeds"] == "1 to 3");
    CHECK(found["skipped"].is_null());
    CHECK(found["figures"]["error_m"] == 0.5);
    CHECK(found["claims"][0]["verdict"] == "holds");
    CHECK(found["claims"][0]["reason"].is_null());
    CHECK(found["claims"][1]["reason"] == "not found yet");
    CHECK(found["headlines"][0]["result"] == "3 seeds");
    CHECK(found["tables"][0]["rows"][0][1] == "<b>2</b>");
}

TEST_CASE("JSON tells of a skipped experiment why, and of nothing else", "[experiments][json]") {
    const nlohmann::ordered_json absent = json_of(sample_report())["experiments"][1];
    CHECK(absent["skipped"] == "no <recording> here");
    CHECK(absent["figures"] == nlohmann::ordered_json::object());
    CHECK(absent["claims"].empty());
}
