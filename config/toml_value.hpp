// Values of a TOML document against the rows of the parameter tables.
#pragma once

#include <toml++/toml.h>

#include <string>
#include <string_view>

#include "config/parameters.hpp"

namespace crspf {

/// Text from the file as a message may show it: on one line, without terminal codes, not endless.
[[nodiscard]] std::string printable(std::string_view text);

/// "a table", "an integer" ...
[[nodiscard]] const char* kind_of(const toml::node& node);

/// What is wrong with a value; empty where nothing is.
template <class Owner>
[[nodiscard]] std::string flaw_of(const ParameterOf<Owner>& parameter, const toml::node& node);

/// Sets the field from a value without flaw.
template <class Owner>
void assign(const ParameterOf<Owner>& parameter, Owner& owner, const toml::node& node);

}  // namespace crspf
