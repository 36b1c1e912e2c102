// Random numbers that are the same on every machine: integers, additions and multiplications only.
#pragma once

#include <cstdint>

namespace crspf::sim {

/// Each part of the simulation owns a stream, so that more people in the world do not change the wheels' slip.
enum class RandomStream : std::uint8_t {
    kTest,
    kWheels,
    kLidar,
    kPeople,
    kTour,
    kStreamLink,
    kVelodyne,
    kBase,
    kCapture,
    kImu,
    kScene,
    kCars,
    kGrain,
    kCamera,
    kLiveLine,
};

/// SplitMix64 (Steele, Lea, Flood 2014).
class Random {
 public:
    Random(std::uint64_t seed, RandomStream stream)
        : state_(seed ^ (static_cast<std::uint64_t>(stream) * 0xd1342543de82ef95U)) {
        next();
    }

    std::uint64_t next() {
        state_ += 0x9e3779b97f4a7c15U;
        std::uint64_t z = state_;
        z = (z ^ (z >> 30U)) * 0xbf58476d1ce4e5b9U;
        z = (z ^ (z >> 27U)) * 0x94d049bb133111ebU;
        return z ^ (z >> 31U);
    }

    /// In [0, 1).
    double uniform() { return static_cast<double>(next() >> 11U) * 0x1p-53; }
    double uniform(double low, double high) { return low + (high - low) * uniform(); }
    /// In [0, count); count > 0.
    std::uint32_t index(std::uint32_t count) { return static_cast<std::uint32_t>(next() % count); }

    /// Mean 0, variance 1: the sum of twelve uniforms, so nothing lies beyond 6. Unlike Box-Muller it needs no libm.
    double normal() {
        std::uint32_t sum = 0;
        for (int draw = 0; draw < 3; ++draw) {
            const std::uint64_t bits = next();
            for (unsigned shift = 0; shift < 64; shift += 16) {
                sum += static_cast<std::uint32_t>((bits >> shift) & 0xffffU);
            }
        }
        return (static_cast<double>(sum) + 6.0) * 0x1p-16 - 6.0;  // + 6: each 16-bit draw is half a step low
    }

    /// Mean 1, never below 0: von Neumann's way to the exponential distribution, by comparisons alone.
    double exponential() {
        double whole = 0.0;
        for (;;) {
            const double first = uniform();
            double last = first;
            double draw = uniform();
            bool accepted = true;  // while an even number of draws fell below the one before
            while (draw < last) {
                last = draw;
                draw = uniform();
                accepted = !accepted;
            }
            if (accepted) {
                return whole + first;
            }
            whole += 1.0;
        }
    }

 private:
    std::uint64_t state_;
};

}  // namespace crspf::sim
