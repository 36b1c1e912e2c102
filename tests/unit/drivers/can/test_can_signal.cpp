#include <algorithm>
#include <array>
#include <bit>
#include <catch2/catch.hpp>
#include <cmath>
#include <cstdint>
#include <limits>
#include <vector>

#include "core/base/rng.hpp"
#include "drivers/can/can_signal.hpp"

using namespace crspf;

namespace {

/// The places of a signal's bits, highest first, walked bit by bit: the definition, not the implementation.
std::vector<std::size_t> places(const CanSignal& signal) {
    std::vector<std::size_t> bits;
    std::size_t bit = signal.start_bit;
    for (unsigned i = 0; i < signal.length; ++i) {
        bits.push_back(bit);
        if (signal.order == ByteOrder::kIntel) {
            ++bit;
        } else {
            bit = bit % 8 == 0 ? bit + 15 : bit - 1;
        }
    }
    if (signal.order == ByteOrder::kIntel) {
        std::reverse(bits.begin(), bits.end());
    }
    return bits;
}

}  // namespace

TEST_CASE("can signal: a published example of Motorola signals") {
    const CanSignal temperature{.start_bit = 0,
                                .length = 12,
                                .order = ByteOrder::kMotorola,
                                .type = SignalType::kSigned,
                                .factor = 0.01,
                                .offset = 250};
    const CanSignal radius{.start_bit = 6, .length = 6, .order = ByteOrder::kMotorola, .factor = 0.1};
    const CanSignal enable{.start_bit = 7, .length = 1, .order = ByteOrder::kMotorola};
    const std::array<std::uint8_t, 8> example{0xC0, 0x06, 0xE0};
    CHECK(decode(enable, example) == 1.0);
    CHECK(decode(radius, example) == Approx(3.2));
    CHECK(decode(temperature, example) == Approx(250.55));
    std::array<std::uint8_t, 8> made{};
    CHECK(encode(enable, made, 1.0));
    CHECK(encode(radius, made, 3.2));
    CHECK(encode(temperature, made, 250.55));
    CHECK(made == example);

    const std::array<std::uint8_t, 8> second{0x80, 0x4A, 0x0F};
    CHECK(decode(enable, second) == 1.0);
    CHECK(decode(radius, second) == 0.0);
    CHECK(decode(temperature, second) == Approx(255.92));
}

TEST_CASE("can signal: a million random signals come back, each bit from its place, and leave the others alone") {
    Rng rng(7);
    const auto below = [&](std::uint32_t n) -> std::size_t { return rng.next() % n; };
    std::uint64_t wrong = 0;
    std::uint64_t tried = 0;
    while (tried < 1'000'000) {
        const std::size_t bytes = below(8) == 0 ? 64 : 8;
        const CanSignal signal{.start_bit = static_cast<std::uint16_t>(below(static_cast<std::uint32_t>(8 * bytes))),
                               .length = static_cast<std::uint8_t>(below(64) + 1),
                               .order = below(2) == 0 ? ByteOrder::kIntel : ByteOrder::kMotorola};
        const std::vector<std::size_t> bits = places(signal);
        const bool inside = std::all_of(bits.begin(), bits.end(), [&](std::size_t bit) { return bit < 8 * bytes; });
        if (inside != fits(signal, bytes)) {
            ++wrong;
            continue;
        }
        if (!inside) {
            continue;
        }
        ++tried;
        std::array<std::uint8_t, 64> payload{};
        for (std::uint8_t& byte : payload) {
            byte = static_cast<std::uint8_t>(rng.next());
        }
        const std::array<std::uint8_t, 64> before = payload;
        const std::uint64_t mask = signal.length == 64 ? ~std::uint64_t{0} : (std::uint64_t{1} << signal.length) - 1;
        const std::uint64_t raw = (std::uint64_t{rng.next()} << 32U) | rng.next();
        insert_bits(signal, payload, raw);
        wrong += extract_bits(signal, payload) != (raw & mask) ? 1U : 0U;
        // Bit by bit, on a sample: it is slow.
        if (tried % 16 == 0) {
            std::array<std::uint8_t, 64> expected = before;
            for (std::size_t i = 0; i < bits.size(); ++i) {
                const std::size_t bit = bits[i];
                const auto one = static_cast<unsigned>((raw >> (signal.length - 1 - i)) & 1U);
                const unsigned cleared = expected[bit / 8] & ~(1U << (bit % 8));
                expected[bit / 8] = static_cast<std::uint8_t>(cleared | (one << (bit % 8)));
            }
            wrong += payload != expected ? 1U : 0U;
        }
    }
    CHECK(wrong == 0);
    // And the walk can tell: Intel and Motorola lie elsewhere.
    CHECK(places({.start_bit = 4, .length = 8, .order = ByteOrder::kIntel}) !=
          places({.start_bit = 4, .length = 8, .order = ByteOrder::kMotorola}));
}

TEST_CASE("can signal: integers are held within their range, floats keep every bit") {
    std::array<std::uint8_t, 8> payload{};
    const CanSignal i10{.start_bit = 3, .length = 10, .type = SignalType::kSigned, .factor = 0.5, .offset = 1};
    for (const auto& [value, expected] : {std::pair(1e9, 256.5), std::pair(-1e9, -255.0), std::pair(3.3, 3.5),
                                          std::pair(-3.3, -3.5), std::pair(0.0, 0.0)}) {
        CHECK(encode(i10, payload, value));
        CHECK(decode(i10, payload) == expected);
    }
    CanSignal ranged = i10;
    ranged.minimum = -2;
    ranged.maximum = 2;
    CHECK(encode(ranged, payload, 7.0));
    CHECK(decode(ranged, payload) == 2.0);

    for (const SignalType type : {SignalType::kSigned, SignalType::kUnsigned}) {
        const CanSignal widest{.start_bit = 0, .length = 64, .type = type};
        CHECK(encode(widest, payload, 1e30));
        CHECK(extract_bits(widest, payload) ==
              (type == SignalType::kSigned ? 0x7FFFFFFFFFFFFFFFU : 0xFFFFFFFFFFFFFFFFU));
        CHECK(encode(widest, payload, -1e30));
        CHECK(extract_bits(widest, payload) == (type == SignalType::kSigned ? 0x8000000000000000U : 0U));
    }

    const double nan = std::numeric_limits<double>::quiet_NaN();
    payload.fill(0x55);
    CHECK_FALSE(encode(i10, payload, nan));
    CHECK_FALSE(encode({.start_bit = 0, .length = 8, .factor = 0}, payload, 1.0));
    CHECK_FALSE(encode({.start_bit = 60, .length = 8}, payload, 1.0));
    CHECK(std::all_of(payload.begin(), payload.end(), [](std::uint8_t byte) { return byte == 0x55; }));
    CHECK_FALSE(decode({.start_bit = 60, .length = 8}, payload).has_value());

    const CanSignal f32{.start_bit = 7, .length = 32, .order = ByteOrder::kMotorola, .type = SignalType::kFloat32};
    CHECK(encode(f32, payload, -1.5));
    CHECK(payload[0] == 0xBF);
    CHECK(payload[1] == 0xC0);
    CHECK(decode(f32, payload) == -1.5);
    CHECK(encode(f32, payload, nan));
    CHECK(std::isnan(*decode(f32, payload)));
    const CanSignal f64{.start_bit = 0, .length = 64, .type = SignalType::kFloat64};
    CHECK(encode(f64, payload, 0.1));
    CHECK(decode(f64, payload) == 0.1);
    CHECK_FALSE(fits({.start_bit = 0, .length = 16, .type = SignalType::kFloat32}, 8));
}
