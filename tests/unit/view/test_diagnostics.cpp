#include "tools/view/diagnostics.hpp"

#include <catch2/catch.hpp>

using namespace crspf::view;

namespace {

/// Of the part with that name.
Json told(const Json& document, const std::string& name) {
    const Json message = diagnostics_of({.stamp_ns = 0, .status = document});
    for (const Json& status : message["status"]) {
        if (status["name"] == name) {
            return status;
        }
    }
    FAIL("nothing is told of " << name);
    return {};
}

}  // namespace

TEST_CASE("diagnostics: what is well is ok, with its numbers as text") {
    const Json document = Json::parse(R"({
        "sources": [{"name": "lidar", "port": "/dev/ttyACM0", "state": "ok", "says": "", "samples": 12,
                     "counts": {"checksum": 3}}],
        "threads": [{"name": "filter", "alive": true, "misses": 0}],
        "pose": {"lost": false, "degenerate": false, "x_m": 1.5, "covariance": [1, 2]},
        "map": {"refused": 0, "problem": ""},
        "output": {"interface": "can1", "bus_open": true, "unsent": 0}})");
    for (const char* const name : {"source lidar", "thread filter", "pose", "map", "output"}) {
        CHECK(told(document, name)["level"] == 0);
    }
    const Json lidar = told(document, "source lidar");
    CHECK(lidar["hardware_id"] == "/dev/ttyACM0");
    CHECK(lidar["values"].back() == Json{{"key", "counts.checksum"}, {"value", "3"}});
    CHECK(told(document, "pose")["values"].size() == 3);  // no list
}

TEST_CASE("diagnostics: what is wrong is said, with the service's own words") {
    const Json document = Json::parse(R"({
        "sources": [{"name": "lidar", "state": "failed", "says": "no such file"}, {"name": "base", "state": "stale"},
                    {"name": "camera", "state": "blind"}],
        "threads": [{"name": "filter", "alive": false}, {"name": "map", "alive": true, "misses": 2}],
        "pose": {"lost": true}, "map": {"problem": "the disk is full"},
        "output": {"interface": "can1", "bus_open": false, "bus_error": "network is down"}})");
    CHECK(told(document, "source lidar")["level"] == 2);
    CHECK(told(document, "source lidar")["message"] == "no such file");
    CHECK(told(document, "source base")["level"] == 3);
    CHECK(told(document, "source camera")["level"] == 1);
    CHECK(told(document, "thread filter")["level"] == 2);
    CHECK(told(document, "thread map")["level"] == 1);
    CHECK(told(document, "pose")["message"] == "lost");
    CHECK(told(document, "map")["message"] == "the disk is full");
    CHECK(told(document, "output")["message"] == "network is down");
}

TEST_CASE("diagnostics: a document of any shape is borne") {
    for (const char* const text :
         {"null", "[1]", "3", R"({"sources": 3, "pose": [], "map": null, "threads": {"a": {}}})",
          R"({"sources": [null, 1, {"name": 7, "state": 1}], "output": {"interface": 1}})"}) {
        const Json message = diagnostics_of({.stamp_ns = 0, .status = Json::parse(text)});
        CHECK(message["status"].is_array());
    }
}
