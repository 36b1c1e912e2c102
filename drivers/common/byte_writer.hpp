// A cursor over a buffer to be sent that cannot run past its end.
#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <span>
#include <type_traits>

namespace crspf {

/// Writes integers and floats of either byte order. A write past the end leaves the buffer as it was and makes ok()
/// false for good. Wait-free.
class ByteWriter {
 public:
    explicit constexpr ByteWriter(std::span<std::uint8_t> buffer) : buffer_(buffer) {}

    [[nodiscard]] constexpr bool ok() const { return ok_; }
    [[nodiscard]] constexpr std::size_t position() const { return at_; }
    [[nodiscard]] constexpr std::span<const std::uint8_t> written() const { return buffer_.first(at_); }

    constexpr void bytes(std::span<const std::uint8_t> from) {
        if (from.size() > buffer_.size() - at_) {
            ok_ = false;
            return;
        }
        for (const std::uint8_t value : from) {
            buffer_[at_++] = value;
        }
    }
    constexpr void byte(std::uint8_t value) { scatter<1>(value, false); }
    template <typename T>
    constexpr void little(T value) {
        static_assert(std::is_integral_v<T>);
        scatter<sizeof(T)>(static_cast<std::uint64_t>(value), false);
    }
    template <typename T>
    constexpr void big(T value) {
        static_assert(std::is_integral_v<T>);
        scatter<sizeof(T)>(static_cast<std::uint64_t>(value), true);
    }
    constexpr void little_float(float value) { little(std::bit_cast<std::uint32_t>(value)); }
    constexpr void little_double(double value) { little(std::bit_cast<std::uint64_t>(value)); }
    constexpr void big_float(float value) { big(std::bit_cast<std::uint32_t>(value)); }

 private:
    template <std::size_t Size>
    constexpr void scatter(std::uint64_t value, bool most_significant_first) {
        if (Size > buffer_.size() - at_) {
            ok_ = false;
            return;
        }
        for (std::size_t i = 0; i < Size; ++i) {
            const std::size_t place = most_significant_first ? Size - 1 - i : i;
            buffer_[at_ + i] = static_cast<std::uint8_t>(value >> (8 * place));
        }
        at_ += Size;
    }

    std::span<std::uint8_t> buffer_;
    std::size_t at_ = 0;
    bool ok_ = true;
};

}  // namespace crspf
