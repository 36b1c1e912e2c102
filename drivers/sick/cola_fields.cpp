#include "drivers/sick/cola_fields.hpp"

namespace crspf {
namespace {

constexpr std::uint8_t kNoDigit = 16;
constexpr std::size_t kMostDigits = 10;  // of 32 bits, decimal

constexpr std::array<std::uint8_t, 256> kDigits = [] {
    std::array<std::uint8_t, 256> table{};
    for (std::uint8_t& digit : table) {
        digit = kNoDigit;
    }
    for (std::uint8_t i = 0; i < 10; ++i) {
        table['0' + std::size_t{i}] = i;
    }
    for (std::uint8_t i = 0; i < 6; ++i) {
        table['A' + std::size_t{i}] = static_cast<std::uint8_t>(10 + i);
    }
    return table;
}();

}  // namespace

std::span<const std::uint8_t> ColaFieldReader::take(std::size_t n) {
    if (n > rest_.size()) {
        ok_ = false;
        rest_ = {};
        return {};
    }
    const std::span<const std::uint8_t> taken = rest_.first(n);
    rest_ = rest_.subspan(n);
    return taken;
}

void ColaFieldReader::expect_space() {
    const std::span<const std::uint8_t> one = take(1);
    ok_ = ok_ && one[0] == ' ';
}

std::uint32_t ColaFieldReader::token(std::size_t width) {
    expect_space();
    const bool is_decimal = !rest_.empty() && (rest_[0] == '+' || rest_[0] == '-');
    const bool negative = is_decimal && rest_[0] == '-';
    const std::uint64_t base = is_decimal ? 10 : 16;
    const std::size_t first = is_decimal ? 1 : 0;
    std::uint64_t value = 0;
    std::size_t at = first;
    for (; at < rest_.size() && rest_[at] != ' '; ++at) {
        const std::uint8_t digit = kDigits[rest_[at]];
        if (digit >= base || at - first >= kMostDigits) {
            ok_ = false;
            return 0;
        }
        value = value * base + digit;
    }
    rest_ = rest_.subspan(at);
    const std::uint64_t limit = std::uint64_t{1} << (8 * width);
    if (at == first || value >= limit || (negative && value > limit / 2)) {
        ok_ = false;
    }
    if (!ok_) {
        return 0;
    }
    return static_cast<std::uint32_t>(negative ? 0 - value : value);
}

std::span<const std::uint8_t> ColaFieldReader::text(std::size_t n) {
    if (dialect_ == ColaDialect::kAscii) {
        expect_space();
    }
    return take(n);
}

std::span<const std::uint8_t> ColaFieldReader::counted_text() {
    const auto length = number<std::uint8_t>();
    return length == 0 || !ok() ? std::span<const std::uint8_t>{} : text(length);
}

void ColaFieldWriter::hexadecimal(std::uint32_t value) {
    const int bits = value == 0 ? 1 : static_cast<int>(std::bit_width(value));
    for (int shift = (bits - 1) / 4 * 4; shift >= 0; shift -= 4) {
        const std::uint32_t digit = (value >> static_cast<unsigned>(shift)) & 15U;
        out_.byte(static_cast<std::uint8_t>(digit < 10 ? '0' + digit : 'A' + (digit - 10)));
    }
}

}  // namespace crspf
