// The table that drives the configuration: parsing, checking, printing and the reference all read it.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "config/config.hpp"

namespace crspf {

/// A double counts without gaps up to here.
inline constexpr double kWholeMax = 9007199254740991.0;

/// One of several names; its number is an enumerator of `value`.
struct Choice {
    std::uint8_t* value;
    std::span<const std::string_view> names;
};

using Field = std::variant<bool*, int*, std::uint32_t*, std::uint64_t*, double*, std::string*, Choice,
                           std::vector<std::uint32_t>*, std::vector<std::string>*>;

/// One key of the file and the field it sets. The field of a key that ends in _deg is in radians; otherwise file and
/// field agree. The default is the field's value in a default-constructed owner.
template <class Owner>
struct ParameterOf {
    std::string_view table;
    std::string_view key;
    Field (*field)(Owner&);
    std::string_view meaning;    ///< one sentence
    std::string_view unit = {};  ///< in the file; empty for plain numbers, texts and booleans
    double minimum = 0.0;        ///< least and largest value, in the file's unit; for numbers and lists of them
    double maximum = 0.0;
    bool whole = false;  ///< a real field that takes whole numbers only
};

using Parameter = ParameterOf<Config>;
using SourceParameter = ParameterOf<SourceConfig>;  ///< its table: the driver's name, or empty where it is all drivers'
using SignalParameter = ParameterOf<SignalConfig>;

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

/// Of [source.NAME], and of the tables of the signals within one.
[[nodiscard]] std::span<const SourceParameter> source_parameters();
[[nodiscard]] std::span<const SignalParameter> signal_parameters();

/// What a signal may be to the odometry: names of the tables within [source.NAME].
[[nodiscard]] std::span<const std::string_view> signal_roles();

/// nullptr where there is no such key.
[[nodiscard]] const Parameter* find_parameter(std::string_view table, std::string_view key);

// The functions below are made for the three kinds of owner.

template <class Owner>
[[nodiscard]] bool is_boolean(const ParameterOf<Owner>& parameter);
template <class Owner>
[[nodiscard]] bool is_real(const ParameterOf<Owner>& parameter);
/// Neither text nor choice nor list.
template <class Owner>
[[nodiscard]] bool is_number(const ParameterOf<Owner>& parameter);

/// Of a number or boolean: the value in the file's unit; false is 0, true is 1.
template <class Owner>
[[nodiscard]] double get(const ParameterOf<Owner>& parameter, const Owner& owner);

/// Sets the field from a number in the file's unit, which is of the field's type and in its range.
template <class Owner>
void set(const ParameterOf<Owner>& parameter, Owner& owner, double number);

/// The value as TOML; for each value that came from a file, and each default, loading it gives the same bits.
template <class Owner>
[[nodiscard]] std::string text_of(const ParameterOf<Owner>& parameter, const Owner& owner);

/// "a real number from 0.0 to 300.0 [m]".
template <class Owner>
[[nodiscard]] std::string expectation(const ParameterOf<Owner>& parameter);

/// "0.0 to 300.0", or the names of a choice; empty for booleans and texts.
template <class Owner>
[[nodiscard]] std::string range_of(const ParameterOf<Owner>& parameter);

/// "real", "text" ...
template <class Owner>
[[nodiscard]] std::string type_of(const ParameterOf<Owner>& parameter);

/// A real number as TOML, as short as it can be without losing a bit.
[[nodiscard]] std::string real_text(double number);

}  // namespace crspf
