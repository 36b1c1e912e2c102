#include "drivers/sick/cola_fields.hpp"

namespace crspf {
namespace {

constexpr int kNoDigit = 16;

constexpr std::array<std::uint8_t, 256> kDigits = [] {
    std::array<std::uint8_t, 256> table{};
    for (std::size_t c = 0; c < table.size(); ++c) {
        table[c] = kNoDigit;
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

void ColaFieldReader::expect_space() {
    ok_ = in_.byte() == ' ' && ok_;
}

std::uint32_t ColaFieldReader::token(std::size_t width) {
    expect_space();
    ByteReader ahead = in_;  // a token ends before the next space, so one byte must be looked at without being read
    std::uint64_t value = 0;
    std::size_t digits = 0;
    std::uint64_t base = 16;
    bool negative = false;
    while (ahead.left() > 0) {
        const std::uint8_t c = ahead.byte();
        if (c == ' ') {
            break;
        }
        if ((c == '+' || c == '-') && digits == 0 && base == 16) {
            base = 10;
            negative = c == '-';
        } else {
            const std::uint8_t digit = kDigits[c];
            ok_ = ok_ && digit < base && digits < 10;
            value = value * base + digit;
            ++digits;
        }
        in_.skip(1);
        if (!ok_) {
            return 0;
        }
    }
    const std::uint64_t limit = std::uint64_t{1} << (8 * width);
    ok_ = ok_ && digits > 0 && value < limit && (!negative || value <= limit / 2);
    if (!ok_) {
        return 0;
    }
    return static_cast<std::uint32_t>(negative ? 0 - value : value);
}

std::span<const std::uint8_t> ColaFieldReader::text(std::size_t n) {
    if (dialect_ == ColaDialect::kAscii) {
        expect_space();
    }
    return in_.take(n);
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
