// Numbers in text files.
#pragma once

#include <array>
#include <charconv>
#include <cmath>
#include <string>

namespace crspf {

/// The fewest digits that read back as the same number, without an exponent.
template <class T>
void append_digits(std::string& out, T value) {
    std::array<char, 400> text{};  // the largest double has 309 digits before the point
    out.append(text.data(), std::to_chars(text.data(), text.data() + text.size(), value, std::chars_format::fixed).ptr);
}

inline void append_fixed(std::string& out, double value, int decimals) {
    std::array<char, 400> text{};
    out.append(text.data(),
               std::to_chars(text.data(), text.data() + text.size(), value, std::chars_format::fixed, decimals).ptr);
}

}  // namespace crspf
