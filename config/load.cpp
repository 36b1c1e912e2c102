#include <toml++/toml.h>

#include <algorithm>
#include <cstddef>
#include <vector>

#include "config/join.hpp"
#include "config/load_sources.hpp"
#include "config/parameters.hpp"
#include "config/problems.hpp"
#include "config/suggest.hpp"
#include "config/toml_value.hpp"
#include "platform/files/read_file.hpp"

namespace crspf {

namespace {

/// Far more than a configuration needs; keeps /dev/zero or a log given by mistake from filling the memory.
constexpr std::size_t kLargestFile = std::size_t{1} << 20U;

/// Holds a parsed document against the parameter table, fills the configuration and collects what is wrong.
class Checker {
 public:
    explicit Checker(Problems& problems) : problems_(problems) {}

    Config check(const toml::table& document) {
        for (const auto& [name, node] : document) {
            check_section(name, node);
        }
        for (const Order& order : orders()) {
            check_order(order, document);
        }
        check_upright(document);
        if (!config_.stereo.calibration.empty() && !config_.stereo.calibration_text.empty()) {
            const toml::node* const place = document["stereo"]["calibration_text"].node();
            problems_.add(place->source().begin, {"[stereo] calibration_text: calibration is there, too; keep one"});
        }
        if (!config_.stereo.calibration.empty()) {
            const std::filesystem::path folder = std::filesystem::path(problems_.file()).parent_path();
            config_.stereo.calibration = (folder / config_.stereo.calibration).string();
        }
        problems_.throw_if_any();
        return config_;
    }

 private:
    void check_section(const toml::key& name, const toml::node& node) {
        const std::string_view table = name.str();
        const toml::source_position at = name.source().begin;
        if (table == "source") {
            config_.sources = load_sources(node, problems_);
            return;
        }
        const bool known =
            std::any_of(sections().begin(), sections().end(), [&](const Section& s) { return s.name == table; });
        if (known && node.is_table()) {
            for (const auto& [key, value] : *node.as_table()) {
                check_key(table, key, value);
            }
        } else if (known) {
            problems_.add(at,
                          {"[", table, "]: is ", kind_of(node), "; write [", table, "] on a line of its own, once"});
        } else if (node.is_table()) {
            problems_.add(at, {"[", printable(table), "]: unknown table; ", remedy_for_table(table)});
        } else {
            problems_.add(at, {printable(table), ": key outside of any table; ", remedy_for_key("", table)});
        }
    }

    void check_key(std::string_view table, const toml::key& key, const toml::node& value) {
        const Parameter* const parameter = find_parameter(table, key.str());
        if (parameter == nullptr) {
            problems_.add(key.source().begin, {"[", table, "] ", printable(key.str()), ": unknown key; ",
                                               remedy_for_key(table, key.str())});
            return;
        }
        const std::string flaw = flaw_of(*parameter, value);
        if (flaw.empty()) {
            assign(*parameter, config_, value);
        } else {
            rejected_.push_back(parameter);
            problems_.add(value.source().begin,
                          {"[", table, "] ", parameter->key, ": ", flaw, "; expected ", expectation(*parameter)});
        }
    }

    /// Compares what the file says with what it leaves at the default, too.
    void check_order(const Order& order, const toml::table& document) {
        const Parameter& lower = *find_parameter(order.table, order.lower);
        const Parameter& upper = *find_parameter(order.table, order.upper);
        const bool comparable = std::none_of(rejected_.begin(), rejected_.end(),
                                             [&](const Parameter* p) { return p == &lower || p == &upper; });
        const double low = get(lower, config_);
        const double high = get(upper, config_);
        if (!comparable || low < high || (order.may_be_equal && low == high)) {
            return;
        }
        const toml::node* const lower_node = document[order.table][order.lower].node();
        const toml::node* const upper_node = document[order.table][order.upper].node();
        const toml::node* const place = lower_node != nullptr ? lower_node : upper_node;
        const auto origin = [](const toml::node* node) { return node == nullptr ? " (default)" : ""; };
        problems_.add(place == nullptr ? toml::source_position{} : place->source().begin,
                      {"[", order.table, "] ", order.lower, ": ", text_of(lower, config_), origin(lower_node),
                       " must be ", order.may_be_equal ? "at most " : "less than ", order.upper, ", ",
                       text_of(upper, config_), origin(upper_node), "; lower the one or raise the other"});
    }

    /// Obstacles stand on the ground: the sensor has to know where it is.
    void check_upright(const toml::table& document) {
        for (const SourceConfig& source : config_.sources) {
            if (gives_clouds(source) && config_.slam.lidar.mount_inverted) {
                const toml::node* const place = document["source"][source.name]["planar"].node();
                problems_.add(place == nullptr ? toml::source_position{} : place->source().begin,
                              {"[source.", source.name,
                               "] planar: obstacles are not found by a lidar that hangs upside down ([lidar] "
                               "mount_inverted); mount it upright, or use planar = \"ring\""});
            }
        }
    }

    Problems& problems_;
    Config config_;
    std::vector<const Parameter*> rejected_;
};

}  // namespace

Config parse_config(std::string_view text, std::string_view name) {
    Problems problems(name);
    toml::table document;
    try {
        document = toml::parse(text);
    } catch (const toml::parse_error& e) {
        problems.add(e.source().begin, {printable(e.description()), "; correct the TOML syntax"});
        problems.throw_if_any();
    }
    return Checker(problems).check(document);
}

Config load_config(const std::filesystem::path& file) {
    return parse_config(read_file(file, kLargestFile), file.string());
}

}  // namespace crspf
