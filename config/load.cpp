#include <toml++/toml.h>

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <cstddef>
#include <fstream>
#include <initializer_list>
#include <system_error>
#include <vector>

#include "config/join.hpp"
#include "config/parameters.hpp"
#include "config/suggest.hpp"
#include "platform/files/input_error.hpp"

namespace crspf {

namespace {

/// Far more than a configuration needs; keeps /dev/zero or a log given by mistake from filling the memory.
constexpr std::size_t kLargestFile = std::size_t{1} << 20U;

/// Text from the file as a message may show it: on one line, without terminal codes, not endless.
std::string printable(std::string_view text) {
    constexpr std::size_t kLongest = 120;
    std::string shown(text.substr(0, kLongest));
    std::replace_if(
        shown.begin(), shown.end(), [](char c) { return static_cast<unsigned char>(c) < 0x20 || c == 0x7f; }, '?');
    return text.size() > kLongest ? join({shown, "..."}) : shown;
}

const char* kind_of(const toml::node& node) {
    switch (node.type()) {
        case toml::node_type::table: return "a table";
        case toml::node_type::array: return "an array";
        case toml::node_type::string: return "a string";
        case toml::node_type::integer: return "an integer";
        case toml::node_type::floating_point: return "a real number";
        case toml::node_type::boolean: return "a boolean";
        case toml::node_type::date: return "a date";
        case toml::node_type::time: return "a time";
        case toml::node_type::date_time: return "a date and time";
        case toml::node_type::none: break;
    }
    return "nothing";
}

/// Of a boolean or a number; false is 0, true is 1.
double number_in(const toml::node& node) {
    if (const auto* flag = node.as_boolean()) {
        return flag->get() ? 1.0 : 0.0;
    }
    if (const auto* integer = node.as_integer()) {
        return static_cast<double>(integer->get());
    }
    return node.as_floating_point()->get();
}

/// What is wrong with a value; empty where nothing is.
std::string flaw_of(const Parameter& parameter, const toml::node& node) {
    const bool type_fits = is_boolean(parameter) ? node.is_boolean()
                           : is_real(parameter)  ? node.is_number()  // 3 will do for 3.0
                                                 : node.is_integer();
    if (!type_fits) {
        return join({"is ", kind_of(node)});
    }
    if (is_boolean(parameter)) {
        return {};
    }
    const double number = number_in(node);
    const std::string given = node.is_integer() ? std::to_string(node.as_integer()->get()) : real_text(number);
    if (!std::isfinite(number)) {
        return join({given, " is not finite"});
    }
    if (number < parameter.minimum || number > parameter.maximum) {
        return join({given, " is out of range"});
    }
    if (parameter.whole && number != std::floor(number)) {
        return join({given, " is not whole"});
    }
    return {};
}

/// Holds a parsed document against the parameter table, fills the configuration and collects what is wrong.
class Checker {
 public:
    explicit Checker(std::string_view name) : name_(name) {}

    Config check(const toml::table& document) {
        for (const auto& [name, node] : document) {
            check_section(name, node);
        }
        for (const Order& order : orders()) {
            check_order(order, document);
        }
        throw_if_any();
        return config_;
    }

    void add(const toml::source_position& at, std::initializer_list<std::string_view> text) {
        problems_.push_back({.at = at, .text = join(text)});
    }

    void throw_if_any() {
        if (problems_.empty()) {
            return;
        }
        std::stable_sort(problems_.begin(), problems_.end(),
                         [](const Problem& a, const Problem& b) { return a.at < b.at; });
        std::string all;
        for (const auto& [at, text] : problems_) {
            const char* const newline = all.empty() ? "" : "\n";
            all += join({newline, name_, ":", std::to_string(at.line), ":", std::to_string(at.column), ": ", text});
        }
        throw InputError(all);
    }

 private:
    struct Problem {
        toml::source_position at;
        std::string text;
    };

    void check_section(const toml::key& name, const toml::node& node) {
        const std::string_view table = name.str();
        const toml::source_position at = name.source().begin;
        const bool known =
            std::any_of(sections().begin(), sections().end(), [&](const Section& s) { return s.name == table; });
        if (known && node.is_table()) {
            for (const auto& [key, value] : *node.as_table()) {
                check_key(table, key, value);
            }
        } else if (known) {
            add(at, {"[", table, "]: is ", kind_of(node), "; write [", table, "] on a line of its own, once"});
        } else if (node.is_table()) {
            add(at, {"[", printable(table), "]: unknown table; ", remedy_for_table(table)});
        } else {
            add(at, {printable(table), ": key outside of any table; ", remedy_for_key("", table)});
        }
    }

    void check_key(std::string_view table, const toml::key& key, const toml::node& value) {
        const Parameter* const parameter = find_parameter(table, key.str());
        if (parameter == nullptr) {
            add(key.source().begin,
                {"[", table, "] ", printable(key.str()), ": unknown key; ", remedy_for_key(table, key.str())});
            return;
        }
        const std::string flaw = flaw_of(*parameter, value);
        if (flaw.empty()) {
            set(*parameter, config_, number_in(value));
        } else {
            rejected_.push_back(parameter);
            add(value.source().begin,
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
        add(place == nullptr ? toml::source_position{} : place->source().begin,
            {"[", order.table, "] ", order.lower, ": ", text_of(lower, config_), origin(lower_node), " must be ",
             order.may_be_equal ? "at most " : "less than ", order.upper, ", ", text_of(upper, config_),
             origin(upper_node), "; lower the one or raise the other"});
    }

    std::string_view name_;
    Config config_;
    std::vector<Problem> problems_;
    std::vector<const Parameter*> rejected_;
};

}  // namespace

Config parse_config(std::string_view text, std::string_view name) {
    Checker checker(name);
    toml::table document;
    try {
        document = toml::parse(text);
    } catch (const toml::parse_error& e) {
        checker.add(e.source().begin, {printable(e.description()), "; correct the TOML syntax"});
        checker.throw_if_any();
    }
    return checker.check(document);
}

Config load_config(const std::filesystem::path& file) {
    errno = 0;
    std::ifstream in(file, std::ios::binary);
    std::string text(kLargestFile + 1, '\0');
    in.read(text.data(), static_cast<std::streamsize>(text.size()));
    if (!in.is_open() || in.bad()) {
        const std::string reason = errno != 0 ? std::generic_category().message(errno) : "unknown reason";
        throw InputError(join({file.string(), ": cannot be read: ", reason, "; check the path and its permissions"}));
    }
    text.resize(static_cast<std::size_t>(in.gcount()));
    if (text.size() > kLargestFile) {
        throw InputError(join({file.string(), ": larger than 1 MiB; this is not a configuration file"}));
    }
    return parse_config(text, file.string());
}

}  // namespace crspf
