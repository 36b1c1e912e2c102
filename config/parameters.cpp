#include "config/parameters.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <initializer_list>
#include <type_traits>

#include "config/join.hpp"

namespace crspf {

namespace {

bool in_degrees(const Parameter& p) {
    return p.key.ends_with("_deg");
}

double as_double(const Field& field) {
    return std::visit([](const auto* value) { return static_cast<double>(*value); }, field);
}

/// What the file's number sets a real field to. Not every number of radians has a number of degrees that converts to
/// it; so that each default at least can be written down, the degrees nearest to a default stand for that default.
double field_value(const Parameter& p, double number) {
    if (!in_degrees(p)) {
        return number;
    }
    Config defaults;
    const double default_rad = as_double(p.field(defaults));
    return number == degrees(default_rad) ? default_rad : radians(number);
}

/// The number that `digits` significant decimal digits leave of `number`.
double rounded(double number, int digits) {
    std::array<char, 32> text{};
    const auto end = std::to_chars(text.data(), text.data() + text.size(), number, std::chars_format::general, digits);
    std::from_chars(text.data(), end.ptr, number);
    return number;
}

/// The shortest number of degrees that sets the field to `value_rad`.
std::string degrees_text(const Parameter& p, double value_rad) {
    const double nearest = degrees(value_rad);
    for (int digits = 1; digits <= 17; ++digits) {
        const double number = rounded(nearest, digits);
        if (field_value(p, number) == value_rad) {
            return real_text(number);
        }
    }
    // The roundings there and back may differ by one unit in the last place.
    for (const double number : {std::nextafter(nearest, -HUGE_VAL), std::nextafter(nearest, HUGE_VAL)}) {
        if (field_value(p, number) == value_rad) {
            return real_text(number);
        }
    }
    return real_text(nearest);
}

}  // namespace

const Parameter* find_parameter(std::string_view table, std::string_view key) {
    const std::span<const Parameter> all = parameters();
    const auto found =
        std::find_if(all.begin(), all.end(), [&](const Parameter& p) { return p.table == table && p.key == key; });
    return found == all.end() ? nullptr : &*found;
}

bool is_boolean(const Parameter& parameter) {
    Config config;
    return std::holds_alternative<bool*>(parameter.field(config));
}

bool is_real(const Parameter& parameter) {
    Config config;
    return std::holds_alternative<double*>(parameter.field(config));
}

double get(const Parameter& parameter, const Config& config) {
    Config copy = config;  // fields are handed out for writing
    const double value = as_double(parameter.field(copy));
    return in_degrees(parameter) ? degrees(value) : value;
}

void set(const Parameter& parameter, Config& config, double number) {
    const double value = field_value(parameter, number);
    std::visit([value](auto* field) { *field = static_cast<std::remove_pointer_t<decltype(field)>>(value); },
               parameter.field(config));
}

std::string text_of(const Parameter& parameter, const Config& config) {
    Config copy = config;
    const Field field = parameter.field(copy);
    if (const auto* const* flag = std::get_if<bool*>(&field)) {
        return **flag ? "true" : "false";
    }
    if (const auto* const* real = std::get_if<double*>(&field)) {
        return in_degrees(parameter) ? degrees_text(parameter, **real) : real_text(**real);
    }
    return std::visit([](const auto* value) { return std::to_string(*value); }, field);
}

std::string expectation(const Parameter& parameter) {
    if (is_boolean(parameter)) {
        return "true or false";
    }
    const char* const kind = !is_real(parameter) ? "an integer" : parameter.whole ? "a whole number" : "a real number";
    const std::string limits = join({kind, " from ", range_of(parameter)});
    return parameter.unit.empty() ? limits : join({limits, " [", parameter.unit, "]"});
}

std::string range_of(const Parameter& parameter) {
    if (is_boolean(parameter)) {
        return {};
    }
    const auto text = [&](double number) {
        return is_real(parameter) ? real_text(number) : std::to_string(static_cast<std::int64_t>(number));
    };
    return join({text(parameter.minimum), " to ", text(parameter.maximum)});
}

std::string real_text(double number) {
    const double size = std::abs(number);
    const bool plain = size == 0.0 || (size > 1e-9 && size < 1e12);  // 0.0001, not 1e-04
    std::array<char, 48> buffer{};
    const auto end = std::to_chars(buffer.data(), buffer.data() + buffer.size(), number,
                                   plain ? std::chars_format::fixed : std::chars_format::scientific);
    const std::string text(buffer.data(), end.ptr);
    // TOML tells a real number from an integer by its point or exponent.
    return text.find_first_of(".en") == std::string::npos ? join({text, ".0"}) : text;
}

}  // namespace crspf
