// The few real-number helpers of the core that need no libm (sqrt is exact by IEEE 754 on every processor).
#pragma once

#include <bit>
#include <cstdint>

namespace crspf {

constexpr double square(double v) {
    return v * v;
}
constexpr double absolute(double v) {
    return v < 0.0 ? -v : v;
}
/// False for NaN and both infinities.
constexpr bool is_finite(double v) {
    return (std::bit_cast<std::uint64_t>(v) & 0x7FF0000000000000ULL) != 0x7FF0000000000000ULL;
}
/// Correctly rounded; 0 for negative arguments, so that a rounding error below zero does no harm.
[[nodiscard]] inline double square_root(double v) {
    return v > 0.0 ? __builtin_sqrt(v) : 0.0;
}
[[nodiscard]] inline float square_root(float v) {
    return v > 0.0F ? __builtin_sqrtf(v) : 0.0F;
}

}  // namespace crspf
