// The fields of a CoLa telegram, the same calls for both dialects: big-endian binary (CoLa-B) or tokens of hexadecimal
// text behind single spaces (CoLa-A).
#pragma once

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <span>
#include <type_traits>

#include "drivers/common/byte_reader.hpp"
#include "drivers/common/byte_writer.hpp"

namespace crspf {

enum class ColaDialect : std::uint8_t { kAscii = 0, kBinary = 1 };  // the values of the command EIHstCola

/// True where `bytes` spell `text`.
template <std::size_t N>
[[nodiscard]] constexpr bool spells(std::span<const std::uint8_t> bytes, const char (&text)[N]) {
    if (bytes.size() != N - 1) {
        return false;
    }
    for (std::size_t i = 0; i + 1 < N; ++i) {
        if (bytes[i] != static_cast<std::uint8_t>(text[i])) {
            return false;
        }
    }
    return true;
}

/// Reads fields one after another. A field that is missing or malformed reads as 0 and makes ok() false for good.
/// Wait-free.
class ColaFieldReader {
 public:
    ColaFieldReader(std::span<const std::uint8_t> bytes, ColaDialect dialect) : rest_(bytes), dialect_(dialect) {}

    [[nodiscard]] bool ok() const { return ok_; }
    [[nodiscard]] std::size_t left() const { return rest_.size(); }

    /// An integer of the width of T. CoLa-A: hexadecimal two's complement, or decimal behind a sign.
    template <typename T>
    T number() {
        static_assert(std::is_integral_v<T> && sizeof(T) <= 4);
        if (dialect_ == ColaDialect::kAscii) {
            return static_cast<T>(token(sizeof(T)));
        }
        return ByteReader(take(sizeof(T))).big<T>();
    }
    float real() { return std::bit_cast<float>(number<std::uint32_t>()); }

    /// Integers of the width of T, widened.
    template <typename T>
    void numbers(std::span<std::uint16_t> into) {
        static_assert(std::is_unsigned_v<T> && sizeof(T) <= 2);
        if (dialect_ == ColaDialect::kAscii) {
            for (std::uint16_t& value : into) {
                value = static_cast<std::uint16_t>(token(sizeof(T)));
            }
            return;
        }
        const std::span<const std::uint8_t> from = take(into.size() * sizeof(T));
        for (std::size_t i = 0; i < from.size() / sizeof(T); ++i) {
            const unsigned high = sizeof(T) == 2 ? from[i * sizeof(T)] : 0U;
            into[i] = static_cast<std::uint16_t>(high << 8U | from[i * sizeof(T) + sizeof(T) - 1]);
        }
    }

    /// `n` bytes of text.
    std::span<const std::uint8_t> text(std::size_t n);

    /// Text behind its length.
    std::span<const std::uint8_t> counted_text();

 private:
    std::span<const std::uint8_t> take(std::size_t n);
    void expect_space();
    std::uint32_t token(std::size_t width);

    std::span<const std::uint8_t> rest_;
    ColaDialect dialect_;
    bool ok_ = true;
};

/// Writes fields one after another. What does not fit makes ok() false for good. Wait-free.
class ColaFieldWriter {
 public:
    /// Begins with the words of a command, "sMN Run".
    template <std::size_t N>
    ColaFieldWriter(std::span<std::uint8_t> buffer, ColaDialect dialect, const char (&words)[N])
        : out_(buffer), dialect_(dialect) {
        for (std::size_t i = 0; i + 1 < N; ++i) {
            out_.byte(static_cast<std::uint8_t>(words[i]));
        }
    }

    [[nodiscard]] bool ok() const { return out_.ok(); }
    [[nodiscard]] std::size_t position() const { return out_.position(); }

    template <typename T>
    void number(T value) {
        static_assert(std::is_integral_v<T> && sizeof(T) <= 4);
        space();
        if (dialect_ == ColaDialect::kBinary) {
            out_.big<T>(value);
        } else {
            hexadecimal(static_cast<std::make_unsigned_t<T>>(value));
        }
    }
    void real(float value) { number(std::bit_cast<std::uint32_t>(value)); }
    void text(std::span<const std::uint8_t> bytes) {
        space();
        out_.bytes(bytes);
    }
    void counted_text(std::span<const std::uint8_t> bytes) {
        number(static_cast<std::uint8_t>(bytes.size()));
        if (!bytes.empty()) {
            text(bytes);
        }
    }

 private:
    // CoLa-B has one space, behind the words; CoLa-A one before each field.
    void space() {
        if (dialect_ == ColaDialect::kAscii || !spaced_) {
            out_.byte(' ');
            spaced_ = true;
        }
    }
    void hexadecimal(std::uint32_t value);

    ByteWriter out_;
    ColaDialect dialect_;
    bool spaced_ = false;
};

}  // namespace crspf
