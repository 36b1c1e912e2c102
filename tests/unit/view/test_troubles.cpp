#include "tools/view/troubles.hpp"

#include <catch2/catch.hpp>

using crspf::view::troubles_of;
using Json = nlohmann::ordered_json;

TEST_CASE("troubles: what should be 0 and is not, and words of what is wrong") {
    CHECK(troubles_of(Json::parse(R"({
        "filter": {"scans": 100, "skipped": 3, "lost": 0}, "map": {"problem": "disk full", "refused": 0},
        "output": {"bus_error": "", "unsent": 7}, "recording": {"lost": 1}})")) ==
          Json::parse(R"({"filter.skipped": 3, "map.problem": "disk full", "output.unsent": 7, "recording.lost": 1})"));
}

TEST_CASE("troubles: a document of another shape has none") {
    for (const char* text :
         {"null", "[]", "{}", R"({"filter": 7, "map": {"problem": [1]}, "output": {"lost": null}})"}) {
        CAPTURE(text);
        CHECK(troubles_of(Json::parse(text)) == Json::object());
    }
}
