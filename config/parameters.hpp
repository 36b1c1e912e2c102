// The table that drives the configuration: parsing, checking, printing and the reference all read it.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <variant>

#include "config/config.hpp"

namespace crspf {

using Field = std::variant<bool*, int*, std::uint32_t*, std::uint64_t*, double*>;

/// One key of the file and the field it sets. The field of a key that ends in _deg is in radians; otherwise file and
/// field agree. The default is the field's value in a default-constructed Config.
struct Parameter {
    std::string_view table;
    std::string_view key;
    Field (*field)(Config&);
    std::string_view meaning;    ///< one sentence
    std::string_view unit = {};  ///< in the file; empty for plain numbers and booleans
    double minimum = 0.0;        ///< least and largest value, in the file's unit; unused for booleans
    double maximum = 0.0;
    bool whole = false;  ///< a real field that takes whole numbers only
};

/// One TOML table of the file.
struct Section {
    std::string_view name;
    std::string_view meaning;
};

/// Two keys of one table of which the first must stay below the second.
struct Order {
    std::string_view table;
    std::string_view lower;
    std::string_view upper;
    bool may_be_equal;
};

/// In the order of the reference. The parameters of a section stand together.
[[nodiscard]] std::span<const Section> sections();
[[nodiscard]] std::span<const Parameter> parameters();
[[nodiscard]] std::span<const Order> orders();

/// nullptr where there is no such key.
[[nodiscard]] const Parameter* find_parameter(std::string_view table, std::string_view key);

[[nodiscard]] bool is_boolean(const Parameter& parameter);
[[nodiscard]] bool is_real(const Parameter& parameter);

/// The value in the file's unit; false is 0, true is 1.
[[nodiscard]] double get(const Parameter& parameter, const Config& config);

/// Sets the field from a number in the file's unit, which is of the field's type and in its range.
void set(const Parameter& parameter, Config& config, double number);

/// The value as TOML; for each value that came from a file, and each default, loading it gives the same bits.
[[nodiscard]] std::string text_of(const Parameter& parameter, const Config& config);

/// "a real number from 0.0 to 300.0 [m]".
[[nodiscard]] std::string expectation(const Parameter& parameter);

/// "0.0 to 300.0"; empty for booleans.
[[nodiscard]] std::string range_of(const Parameter& parameter);

/// A real number as TOML, as short as it can be without losing a bit.
[[nodiscard]] std::string real_text(double number);

}  // namespace crspf
