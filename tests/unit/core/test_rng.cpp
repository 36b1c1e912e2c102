#include <array>
#include <catch2/catch.hpp>
#include <cmath>

#include "core/base/rng.hpp"

using namespace crspf;

TEST_CASE("the generator is PCG32, as its author's test prints it for seed 42") {
    // check-pcg32_oneseq.out of the PCG library.
    constexpr std::array<std::uint32_t, 6> kExpected{0xc2f57bd6U, 0x6b07c4a9U, 0x72b7b29bU,
                                                     0x44215383U, 0xf5af5eadU, 0x68beb632U};
    Rng rng(42);
    for (const std::uint32_t expected : kExpected) {
        CHECK(rng.next() == expected);
    }
}

TEST_CASE("a seed is a sequence") {
    Rng a(7);
    Rng b(7);
    Rng other(8);
    int equal = 0;
    for (int i = 0; i < 1000; ++i) {
        const std::uint32_t value = a.next();
        REQUIRE(value == b.next());
        equal += value == other.next() ? 1 : 0;
    }
    CHECK(equal < 3);
}

TEST_CASE("symmetric numbers fill -1 to below 1 evenly in steps of 2^-31") {
    constexpr int kCount = 100000;
    constexpr std::size_t kBins = 20;
    std::array<int, kBins> bins{};
    Rng rng(5);
    for (int i = 0; i < kCount; ++i) {
        const double v = rng.symmetric();
        REQUIRE(v >= -1.0);
        REQUIRE(v < 1.0);
        REQUIRE(std::floor(v * 2147483648.0) == v * 2147483648.0);
        ++bins[static_cast<std::size_t>((v + 1.0) * 0.5 * kBins)];
    }
    double chi_squared = 0.0;
    for (const int count : bins) {
        constexpr double kMean = static_cast<double>(kCount) / kBins;
        chi_squared += (count - kMean) * (count - kMean) / kMean;
    }
    CHECK(chi_squared < 43.8);  // 19 degrees of freedom, 1 in 1000
}
