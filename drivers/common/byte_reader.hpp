// A cursor over received bytes that cannot run past their end.
#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <span>
#include <type_traits>

namespace crspf {

/// Reads integers and floats of either byte order. A read past the end gives 0 and makes ok() false for good, so that a
/// parser asks once, at the end. Wait-free.
class ByteReader {
 public:
    explicit constexpr ByteReader(std::span<const std::uint8_t> bytes) : bytes_(bytes) {}

    [[nodiscard]] constexpr bool ok() const { return ok_; }
    [[nodiscard]] constexpr std::size_t position() const { return at_; }
    [[nodiscard]] constexpr std::size_t left() const { return bytes_.size() - at_; }

    /// The next `n` bytes; empty past the end.
    constexpr std::span<const std::uint8_t> take(std::size_t n) {
        if (n > left()) {
            ok_ = false;
            at_ = bytes_.size();
            return {};
        }
        at_ += n;
        return bytes_.subspan(at_ - n, n);
    }
    constexpr void skip(std::size_t n) { static_cast<void>(take(n)); }

    template <typename T>
    constexpr T little() {
        static_assert(std::is_integral_v<T>);
        return static_cast<T>(gather<sizeof(T)>(false));
    }
    template <typename T>
    constexpr T big() {
        static_assert(std::is_integral_v<T>);
        return static_cast<T>(gather<sizeof(T)>(true));
    }
    constexpr std::uint8_t byte() { return little<std::uint8_t>(); }
    constexpr float little_float() { return std::bit_cast<float>(little<std::uint32_t>()); }
    constexpr double little_double() { return std::bit_cast<double>(little<std::uint64_t>()); }
    constexpr float big_float() { return std::bit_cast<float>(big<std::uint32_t>()); }

 private:
    template <std::size_t Size>
    constexpr std::uint64_t gather(bool most_significant_first) {
        const std::span<const std::uint8_t> from = take(Size);
        std::uint64_t value = 0;
        for (std::size_t i = 0; i < from.size(); ++i) {
            const std::size_t place = most_significant_first ? Size - 1 - i : i;
            value |= static_cast<std::uint64_t>(from[i]) << (8 * place);
        }
        return value;
    }

    std::span<const std::uint8_t> bytes_;
    std::size_t at_ = 0;
    bool ok_ = true;
};

}  // namespace crspf
