// The blank-separated fields of a line of text, one after the other, without copies and without a locale.
#pragma once

#include <charconv>
#include <concepts>
#include <limits>
#include <string_view>
#include <system_error>

namespace crspf {

/// Views the line, which must outlive it. Blanks are space, tab, carriage return, vertical tab and form feed.
class Fields {
 public:
    explicit Fields(std::string_view line) : at_(line.data()), end_(line.data() + line.size()) { skip_blanks(); }

    [[nodiscard]] bool at_end() const { return at_ == end_; }

    /// The next field; empty at the end of the line.
    std::string_view word() {
        const char* begin = at_;
        while (at_ != end_ && !is_blank(*at_)) {
            ++at_;
        }
        const std::string_view field(begin, static_cast<std::size_t>(at_ - begin));
        skip_blanks();
        return field;
    }

    /// Reads the next field. False, and nothing consumed, at the end of the line and where the field is not wholly a
    /// number. A floating-point field takes "nan" and "inf"; one beyond the type's range reads as NaN.
    template <typename Number>
    [[nodiscard]] bool number(Number& value) {
        const auto [end, error] = std::from_chars(at_, end_, value);
        if (error == std::errc::invalid_argument || (end != end_ && !is_blank(*end))) {
            return false;
        }
        if (error == std::errc::result_out_of_range) {
            if constexpr (std::floating_point<Number>) {
                value = std::numeric_limits<Number>::quiet_NaN();
            } else {
                return false;
            }
        }
        at_ = end;
        skip_blanks();
        return true;
    }

    /// Reads the next fields, as many as there are arguments.
    template <typename... Numbers>
    [[nodiscard]] bool numbers(Numbers&... values) {
        return (number(values) && ...);
    }

 private:
    static bool is_blank(char c) { return c == ' ' || (c >= '\t' && c <= '\r' && c != '\n'); }

    void skip_blanks() {
        while (at_ != end_ && is_blank(*at_)) {
            ++at_;
        }
    }

    const char* at_;
    const char* end_;
};

}  // namespace crspf
