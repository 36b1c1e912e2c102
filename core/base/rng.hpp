// The filter's own random numbers: seeded, portable, the same on every machine.
#pragma once

#include <cstdint>

namespace crspf {

/// PCG32 (O'Neill 2014): 64 bits of state, 32 bits out, period 2^64. Wait-free.
class Rng {
 public:
    explicit constexpr Rng(std::uint64_t seed) {
        next();
        state_ += seed;
        next();
    }

    constexpr std::uint32_t next() {
        const std::uint64_t old = state_;
        state_ = old * 6364136223846793005ULL + 1442695040888963407ULL;
        const auto shifted = static_cast<std::uint32_t>(((old >> 18U) ^ old) >> 27U);
        const auto turn = static_cast<std::uint32_t>(old >> 59U);
        return (shifted >> turn) | (shifted << ((32U - turn) & 31U));
    }

    /// Uniform in [-1, 1), in steps of 2^-31: exact in a double.
    constexpr double symmetric() {
        return static_cast<double>(static_cast<std::int32_t>(next())) * (1.0 / 2147483648.0);
    }

 private:
    std::uint64_t state_ = 0;
};

}  // namespace crspf
