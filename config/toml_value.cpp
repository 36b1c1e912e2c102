#include "config/toml_value.hpp"

#include <algorithm>
#include <cmath>

#include "config/join.hpp"

namespace crspf {

namespace {

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

template <class Owner>
std::string flaw_of_number(const ParameterOf<Owner>& parameter, const toml::node& node) {
    if (!(is_real(parameter) ? node.is_number() : node.is_integer())) {  // 3 will do for 3.0
        return join({"is ", kind_of(node)});
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

}  // namespace

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

template <class Owner>
std::string flaw_of(const ParameterOf<Owner>& parameter, const toml::node& node) {
    Owner owner;
    const Field field = parameter.field(owner);
    if (std::holds_alternative<bool*>(field)) {
        return node.is_boolean() ? std::string() : join({"is ", kind_of(node)});
    }
    if (is_number(parameter)) {
        return flaw_of_number(parameter, node);
    }
    if (std::holds_alternative<std::vector<std::uint32_t>*>(field)) {
        if (!node.is_array()) {
            return join({"is ", kind_of(node)});
        }
        for (const toml::node& element : *node.as_array()) {
            if (!element.is_integer()) {
                return join({"holds ", kind_of(element)});
            }
            const auto number = static_cast<double>(element.as_integer()->get());
            if (number < parameter.minimum || number > parameter.maximum) {
                return join({std::to_string(element.as_integer()->get()), " is out of range"});
            }
        }
        return {};
    }
    if (std::holds_alternative<std::vector<std::string>*>(field) && node.is_array()) {
        for (const toml::node& element : *node.as_array()) {
            if (!element.is_string()) {
                return join({"holds ", kind_of(element)});
            }
        }
        return {};
    }
    if (!node.is_string()) {
        return join({"is ", kind_of(node)});
    }
    if (const auto* choice = std::get_if<Choice>(&field)) {
        const std::string& name = node.as_string()->get();
        const bool known = std::find(choice->names.begin(), choice->names.end(), name) != choice->names.end();
        return known ? std::string() : join({"\"", printable(name), "\" is none of them"});
    }
    return {};
}

template <class Owner>
void assign(const ParameterOf<Owner>& parameter, Owner& owner, const toml::node& node) {
    const Field field = parameter.field(owner);
    if (std::string* const* text = std::get_if<std::string*>(&field)) {
        **text = node.as_string()->get();
    } else if (const auto* choice = std::get_if<Choice>(&field)) {
        const auto at = std::find(choice->names.begin(), choice->names.end(), node.as_string()->get());
        *choice->value = static_cast<std::uint8_t>(at - choice->names.begin());
    } else if (std::vector<std::uint32_t>* const* list = std::get_if<std::vector<std::uint32_t>*>(&field)) {
        (*list)->clear();
        for (const toml::node& element : *node.as_array()) {
            (*list)->push_back(static_cast<std::uint32_t>(element.as_integer()->get()));
        }
    } else if (std::vector<std::string>* const* texts = std::get_if<std::vector<std::string>*>(&field)) {
        (*texts)->clear();
        if (node.is_string()) {
            (*texts)->push_back(node.as_string()->get());
        } else {
            for (const toml::node& element : *node.as_array()) {
                (*texts)->push_back(element.as_string()->get());
            }
        }
    } else {
        set(parameter, owner, number_in(node));
    }
}

template std::string flaw_of(const ParameterOf<Config>&, const toml::node&);
template std::string flaw_of(const ParameterOf<SourceConfig>&, const toml::node&);
template std::string flaw_of(const ParameterOf<SignalConfig>&, const toml::node&);
template void assign(const ParameterOf<Config>&, Config&, const toml::node&);
template void assign(const ParameterOf<SourceConfig>&, SourceConfig&, const toml::node&);
template void assign(const ParameterOf<SignalConfig>&, SignalConfig&, const toml::node&);

}  // namespace crspf
