// Where a signal lies in a frame's bytes, and what its bits mean: the bit numbering of DBC files.
//
// Bit n of byte b has the number 8 b + n. An Intel signal is named by its least significant bit and grows upwards in
// that numbering. A Motorola signal is named by its most significant bit and goes on down to bit 0 of that byte, then
// from bit 7 of the next byte.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

namespace crspf {

enum class ByteOrder : std::uint8_t { kIntel, kMotorola };

enum class SignalType : std::uint8_t { kUnsigned, kSigned, kFloat32, kFloat64 };

/// value = raw * factor + offset, in whatever unit the DBC file states.
struct CanSignal {
    std::uint16_t start_bit = 0;  ///< as DBC numbers bits
    std::uint8_t length = 1;      ///< [bits] 1 to 64; 32 or 64 for the floats
    ByteOrder order = ByteOrder::kIntel;
    SignalType type = SignalType::kUnsigned;
    double factor = 1.0;
    double offset = 0.0;
    double minimum =
        0.0;  ///< of the value, for encoding; where it is not below `maximum`, the type's range alone holds
    double maximum = 0.0;
};

// All below: wait-free, no heap, no throw.

/// Whether the length suits the type and every bit lies within `bytes` of payload.
[[nodiscard]] bool fits(const CanSignal& signal, std::size_t bytes);

/// The signal's bits, right-aligned. The signal must fit the payload.
[[nodiscard]] std::uint64_t extract_bits(const CanSignal& signal, std::span<const std::uint8_t> payload);
/// Puts the lowest bits of `raw` in their place; all other bits stay. The signal must fit the payload.
void insert_bits(const CanSignal& signal, std::span<std::uint8_t> payload, std::uint64_t raw);

/// What the bits mean. Integers of more than 53 bits lose their lowest ones.
[[nodiscard]] double value_of(const CanSignal& signal, std::uint64_t raw);
/// The bits that come nearest to `value`, held within [minimum, maximum] and what the field can hold. Nothing for NaN,
/// which has a place in the float types only, and for a factor of 0.
[[nodiscard]] std::optional<std::uint64_t> bits_of(const CanSignal& signal, double value);

/// The value in a payload; nothing where the signal does not fit it.
[[nodiscard]] std::optional<double> decode(const CanSignal& signal, std::span<const std::uint8_t> payload);
/// False, and the payload as it was, where the signal does not fit it or the value has no bits.
[[nodiscard]] bool encode(const CanSignal& signal, std::span<std::uint8_t> payload, double value);

}  // namespace crspf
