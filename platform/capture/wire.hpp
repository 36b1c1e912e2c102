// Integers of either byte order within bytes whose length the caller has checked.
#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <span>
#include <type_traits>
#include <vector>

namespace crspf::wire {

enum class Order : std::uint8_t { kLittle, kBig };

/// What this machine writes as it is.
inline constexpr Order kNative = std::endian::native == std::endian::little ? Order::kLittle : Order::kBig;

template <typename T>
[[nodiscard]] constexpr T get(std::span<const std::uint8_t> bytes, std::size_t at, Order order) {
    static_assert(std::is_unsigned_v<T>);
    std::uint64_t value = 0;
    for (std::size_t i = 0; i < sizeof(T); ++i) {
        const std::size_t place = order == Order::kBig ? sizeof(T) - 1 - i : i;
        value |= static_cast<std::uint64_t>(bytes[at + i]) << (8 * place);
    }
    return static_cast<T>(value);
}

template <typename T>
[[nodiscard]] constexpr T big(std::span<const std::uint8_t> bytes, std::size_t at) {
    return get<T>(bytes, at, Order::kBig);
}

template <typename T>
void append(std::vector<std::uint8_t>& out, T value, Order order) {
    static_assert(std::is_unsigned_v<T>);
    for (std::size_t i = 0; i < sizeof(T); ++i) {
        const std::size_t place = order == Order::kBig ? sizeof(T) - 1 - i : i;
        out.push_back(static_cast<std::uint8_t>(static_cast<std::uint64_t>(value) >> (8 * place)));
    }
}

}  // namespace crspf::wire
