#include <catch2/catch.hpp>
#include <cstdint>
#include <fstream>
#include <regex>
#include <sstream>
#include <string>

#include "config/parameters.hpp"
#include "core/base/rng.hpp"

namespace crspf {
namespace {

std::string source_file(const std::string& path) {
    std::ifstream in(std::string(CRSPF_SOURCE_DIR) + "/" + path, std::ios::binary);
    REQUIRE(in);
    std::ostringstream text;
    text << in.rdbuf();
    return text.str();
}

void check_same(const Config& a, const Config& b) {
    for (const Parameter& p : parameters()) {
        INFO(p.table << "." << p.key);
        CHECK(get(p, a) == get(p, b));
    }
}

/// A valid configuration with every value drawn at random; `digits` as a human or as a program would write them.
Config random_config(Rng& rng, bool round) {
    Config config;
    for (const Parameter& p : parameters()) {
        const double unit = 0.5 * (rng.symmetric() + 1.0);
        double number = is_boolean(p) ? (unit < 0.5 ? 0.0 : 1.0) : p.minimum + unit * (p.maximum - p.minimum);
        if (!is_real(p) || p.whole || (round && number >= p.minimum + 1.0)) {
            number = static_cast<double>(static_cast<std::int64_t>(number));
        }
        set(p, config, number);
    }
    for (const Order& o : orders()) {
        set(*find_parameter(o.table, o.lower), config, find_parameter(o.table, o.lower)->minimum);
        set(*find_parameter(o.table, o.upper), config, find_parameter(o.table, o.upper)->maximum);
    }
    return config;
}

TEST_CASE("the printed defaults load back to the defaults, bit for bit") {
    check_same(parse_config(print_config(Config{}), "printed"), Config{});
}

TEST_CASE("any printed configuration loads back bit for bit") {
    Rng rng(1);
    for (int i = 0; i < 500; ++i) {
        const Config config = random_config(rng, i % 2 == 0);
        const std::string printed = print_config(config);
        const Config loaded = parse_config(printed, "printed");
        check_same(loaded, config);
        CHECK(print_config(loaded) == printed);
    }
}

TEST_CASE("every angle that a file can hold is printed so that it loads back bit for bit") {
    const Parameter& yaw = *find_parameter("lidar", "yaw_deg");
    Rng rng(2);
    int long_texts = 0;
    for (int i = 0; i < 20000; ++i) {
        Config config;
        set(yaw, config, 180.0 * (rng.symmetric() + 0x1p-40 * rng.symmetric()) / (1.0 + 0x1p-30));
        const std::string text = text_of(yaw, config);
        Config loaded;
        set(yaw, loaded, std::stod(text));
        REQUIRE(loaded.slam.lidar.P_base_lidar.theta_rad == config.slam.lidar.P_base_lidar.theta_rad);
        long_texts += text.size() > 16 ? 1 : 0;
    }
    CHECK(long_texts > 1000);  // the sample is not made of easy numbers only
}

TEST_CASE("printing tells the defaults from what was set") {
    Config config;
    config.slam.lidar.range_max_m = 5.6;
    const std::string printed = print_config(config);
    const std::string standard = text_of(*find_parameter("lidar", "range_max_m"), Config{});
    // Not Catch's matcher: it has to match all of the text, at the depth of a call for each character.
    CHECK(std::regex_search(printed, std::regex("\nrange_max_m = 5\\.6 +# default: " + standard + "\n")));
    CHECK(std::regex_search(printed, std::regex("\nrange_min_m = 0\\.05 +# default\n")));
}

TEST_CASE("docs/configuration.md is up to date") {
    INFO("crspf config --reference > docs/configuration.md");
    const bool up_to_date = source_file("docs/configuration.md") == config_reference();  // no diff of whole files
    CHECK(up_to_date);
}

TEST_CASE("the list of capacities names every bound of config/capacities.hpp") {
    const std::string header = source_file("config/capacities.hpp");
    const std::string listing = list_capacities();
    const std::regex bound("inline constexpr [^=;]* (k\\w+) = (\\d+);");
    int found = 0;
    for (std::sregex_iterator match(header.begin(), header.end(), bound), end; match != end; ++match, ++found) {
        INFO((*match)[1]);
        CHECK(std::regex_search(listing, std::regex("  " + (*match)[1].str() + " +" + (*match)[2].str() + " ")));
    }
    std::size_t declared = 0;
    for (std::size_t at = header.find("inline constexpr"); at != std::string::npos; ++declared) {
        at = header.find("inline constexpr", at + 1);
    }
    CHECK(found == static_cast<int>(declared));
    CHECK(found > 0);
}

}  // namespace
}  // namespace crspf
