#include "config/parameters.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <initializer_list>
#include <type_traits>

#include "config/join.hpp"

namespace crspf {

namespace {

template <class Owner>
bool in_degrees(const ParameterOf<Owner>& p) {
    return p.key.ends_with("_deg");
}

template <class T>
constexpr bool kIsNumber = std::is_arithmetic_v<std::remove_pointer_t<T>>;

double as_double(const Field& field) {
    return std::visit(
        [](auto value) {
            if constexpr (kIsNumber<decltype(value)>) {
                return static_cast<double>(*value);
            } else {
                return 0.0;
            }
        },
        field);
}

template <class T, class Owner>
bool holds(const ParameterOf<Owner>& parameter) {
    Owner owner;
    return std::holds_alternative<T>(parameter.field(owner));
}

/// A text as TOML: on one line where it is one.
std::string toml_text(std::string_view text) {
    const bool lines = text.find('\n') != text.npos;
    std::string out = lines ? "\"\"\"\n" : "\"";
    for (const char c : text) {
        if (c == '"' || c == '\\') {
            out += '\\';
            out += c;
        } else if (c != '\n' && (static_cast<unsigned char>(c) < 0x20 || c == 0x7f)) {
            std::array<char, 8> code{};
            std::snprintf(code.data(), code.size(), "\\u%04X", static_cast<unsigned>(c));
            out += code.data();
        } else {
            out += c;
        }
    }
    return out + (lines ? R"(""")" : R"(")");
}

/// What the file's number sets a real field to. Not every number of radians has a number of degrees that converts to
/// it; so that each default at least can be written down, the degrees nearest to a default stand for that default.
template <class Owner>
double field_value(const ParameterOf<Owner>& p, double number) {
    if (!in_degrees(p)) {
        return number;
    }
    Owner defaults;
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
template <class Owner>
std::string degrees_text(const ParameterOf<Owner>& p, double value_rad) {
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

template <class Owner>
bool is_boolean(const ParameterOf<Owner>& parameter) {
    return holds<bool*>(parameter);
}

template <class Owner>
bool is_real(const ParameterOf<Owner>& parameter) {
    return holds<double*>(parameter);
}

template <class Owner>
bool is_number(const ParameterOf<Owner>& parameter) {
    return !is_boolean(parameter) && !holds<std::string*>(parameter) && !holds<Choice>(parameter) &&
           !holds<std::vector<std::uint32_t>*>(parameter) && !holds<std::vector<std::string>*>(parameter);
}

template <class Owner>
double get(const ParameterOf<Owner>& parameter, const Owner& owner) {
    Owner copy = owner;  // fields are handed out for writing
    const double value = as_double(parameter.field(copy));
    return in_degrees(parameter) ? degrees(value) : value;
}

template <class Owner>
void set(const ParameterOf<Owner>& parameter, Owner& owner, double number) {
    const double value = field_value(parameter, number);
    std::visit(
        [value](auto field) {
            if constexpr (kIsNumber<decltype(field)>) {
                *field = static_cast<std::remove_pointer_t<decltype(field)>>(value);
            }
        },
        parameter.field(owner));
}

template <class Owner>
std::string text_of(const ParameterOf<Owner>& parameter, const Owner& owner) {
    Owner copy = owner;
    const Field field = parameter.field(copy);
    if (const auto* const* flag = std::get_if<bool*>(&field)) {
        return **flag ? "true" : "false";
    }
    if (const auto* const* real = std::get_if<double*>(&field)) {
        return in_degrees(parameter) ? degrees_text(parameter, **real) : real_text(**real);
    }
    if (const auto* const* text = std::get_if<std::string*>(&field)) {
        return toml_text(**text);
    }
    if (const auto* choice = std::get_if<Choice>(&field)) {
        return toml_text(choice->names[*choice->value]);
    }
    if (const auto* const* list = std::get_if<std::vector<std::uint32_t>*>(&field)) {
        std::string out;
        for (const std::uint32_t number : **list) {
            out += join({out.empty() ? "" : ", ", std::to_string(number)});
        }
        return join({"[", out, "]"});
    }
    if (const auto* const* texts = std::get_if<std::vector<std::string>*>(&field)) {
        std::string out;
        for (const std::string& text : **texts) {
            out += join({out.empty() ? "" : ", ", toml_text(text)});
        }
        return join({"[", out, "]"});
    }
    return std::visit(
        [](auto value) {
            if constexpr (kIsNumber<decltype(value)>) {
                return std::to_string(*value);
            } else {
                return std::string();
            }
        },
        field);
}

template <class Owner>
std::string expectation(const ParameterOf<Owner>& parameter) {
    if (is_boolean(parameter)) {
        return "true or false";
    }
    if (holds<std::string*>(parameter)) {
        return "a text";
    }
    if (holds<std::vector<std::string>*>(parameter)) {
        return "a text or an array of texts";
    }
    if (holds<Choice>(parameter)) {
        return join({"one of ", range_of(parameter)});
    }
    const char* const kind = holds<std::vector<std::uint32_t>*>(parameter) ? "a list of integers"
                             : !is_real(parameter)                         ? "an integer"
                             : parameter.whole                             ? "a whole number"
                                                                           : "a real number";
    const std::string limits = join({kind, " from ", range_of(parameter)});
    return parameter.unit.empty() ? limits : join({limits, " [", parameter.unit, "]"});
}

template <class Owner>
std::string range_of(const ParameterOf<Owner>& parameter) {
    if (is_boolean(parameter) || holds<std::string*>(parameter) || holds<std::vector<std::string>*>(parameter)) {
        return {};
    }
    Owner owner;
    const Field field = parameter.field(owner);
    if (const auto* choice = std::get_if<Choice>(&field)) {
        std::string out;
        for (const std::string_view name : choice->names) {
            out += join({out.empty() ? "" : ", ", toml_text(name)});
        }
        return out;
    }
    const auto text = [&](double number) {
        return is_real(parameter) ? real_text(number) : std::to_string(static_cast<std::int64_t>(number));
    };
    return join({text(parameter.minimum), " to ", text(parameter.maximum)});
}

template <class Owner>
std::string type_of(const ParameterOf<Owner>& parameter) {
    return is_boolean(parameter)                           ? "boolean"
           : holds<std::string*>(parameter)                ? "text"
           : holds<std::vector<std::string>*>(parameter)   ? "texts"
           : holds<Choice>(parameter)                      ? "choice"
           : holds<std::vector<std::uint32_t>*>(parameter) ? "integers"
           : !is_real(parameter)                           ? "integer"
           : parameter.whole                               ? "real, whole"
                                                           : "real";
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

// NOLINTBEGIN(bugprone-macro-parentheses): a type cannot stand in parentheses
#define CRSPF_OWNER(Owner)                                                 \
    template bool is_boolean(const ParameterOf<Owner>&);                   \
    template bool is_real(const ParameterOf<Owner>&);                      \
    template bool is_number(const ParameterOf<Owner>&);                    \
    template double get(const ParameterOf<Owner>&, const Owner&);          \
    template void set(const ParameterOf<Owner>&, Owner&, double);          \
    template std::string text_of(const ParameterOf<Owner>&, const Owner&); \
    template std::string expectation(const ParameterOf<Owner>&);           \
    template std::string range_of(const ParameterOf<Owner>&);              \
    template std::string type_of(const ParameterOf<Owner>&);
CRSPF_OWNER(Config)
CRSPF_OWNER(SourceConfig)
CRSPF_OWNER(SignalConfig)
#undef CRSPF_OWNER
// NOLINTEND(bugprone-macro-parentheses)

}  // namespace crspf
