#include <algorithm>
#include <catch2/catch.hpp>
#include <set>
#include <string>
#include <type_traits>
#include <variant>

#include "config/parameters.hpp"
#include "core/slam/match_field.hpp"

namespace crspf {
namespace {

// With the count that parameters.cpp asserts, this says: every field of every struct has exactly one key.
TEST_CASE("no two keys set the same field, and no key appears twice") {
    Config config;
    std::set<const void*> fields;
    std::set<std::string> names;
    for (const Parameter& p : parameters()) {
        const void* const address = std::visit(
            [](auto f) -> const void* {
                if constexpr (std::is_pointer_v<decltype(f)>) {
                    return f;
                } else {
                    return f.value;
                }
            },
            p.field(config));
        INFO(p.table << "." << p.key);
        CHECK(fields.insert(address).second);
        CHECK(names.insert(std::string(p.table) + "." + std::string(p.key)).second);
    }
}

TEST_CASE("the parameters stand in the order of the sections, and none is outside") {
    std::size_t seen = 0;
    for (const Section& section : sections()) {
        while (seen < parameters().size() && parameters()[seen].table == section.name) {
            ++seen;
        }
    }
    CHECK(seen == parameters().size());
}

TEST_CASE("every default is allowed by its own range") {
    const Config defaults;
    for (const Parameter& p : parameters()) {
        INFO(p.table << "." << p.key);
        if (is_number(p)) {
            CHECK(p.minimum < p.maximum);
            CHECK(get(p, defaults) >= p.minimum);
            CHECK(get(p, defaults) <= p.maximum);
        }
    }
}

// The configuration knows the core's parameters but not its algorithms, so the scale of (10) is stated twice.
TEST_CASE("match values range over the core's scale") {
    CHECK(find_parameter("particle_filter", "match_max")->maximum == kMatchMax);
    CHECK(find_parameter("analyser", "result_on")->maximum == kMatchMax);
}

TEST_CASE("a key ends in its unit, so that nobody has to guess it") {
    for (const Parameter& p : parameters()) {
        INFO(p.table << "." << p.key);
        CHECK(p.key.ends_with("_m") == (p.unit == "m"));
        CHECK(p.key.ends_with("_s") == (p.unit == "s"));
        CHECK(p.key.ends_with("_deg") == (p.unit == "deg" || p.unit == "deg/m" || p.unit == "deg/s"));
        CHECK_FALSE(p.key.ends_with("_rad"));
    }
}

TEST_CASE("every meaning is one sentence that fits a Markdown table") {
    for (const Parameter& p : parameters()) {
        INFO(p.table << "." << p.key);
        CHECK(p.meaning.ends_with('.'));
        CHECK(p.meaning.find_first_of("|\n") == std::string_view::npos);
    }
}

TEST_CASE("angles are degrees outside and radians inside") {
    const Parameter& yaw = *find_parameter("lidar", "yaw_deg");
    Config config;
    set(yaw, config, 90.0);
    CHECK(config.slam.lidar.P_base_lidar.theta_rad == radians(90.0));
    CHECK(get(yaw, config) == Approx(90.0));
    CHECK(text_of(yaw, config) == "90.0");
}

TEST_CASE("real numbers are written as TOML reals, without losing a bit") {
    CHECK(real_text(3.0) == "3.0");
    CHECK(real_text(-0.0) == "-0.0");
    CHECK(real_text(0.1) == "0.1");
    CHECK(real_text(1e-5) == "0.00001");
    CHECK(real_text(1e300) == "1e+300");
    CHECK(std::stod(real_text(60.0 / 720.0)) == 60.0 / 720.0);
}

}  // namespace
}  // namespace crspf
