#include "drivers/can/can_signal.hpp"

#include <algorithm>
#include <bit>
#include <cmath>  // isnan, round

namespace crspf {
namespace {

/// The highest value of a field of `length` bits.
constexpr std::uint64_t ones(unsigned length) {
    return length >= 64 ? ~std::uint64_t{0} : (std::uint64_t{1} << length) - 1;
}

/// A run of a signal's bits within one byte.
struct Piece {
    std::size_t byte;
    unsigned shift;  ///< of its lowest bit in the byte
    unsigned width;  ///< [bits]
    unsigned place;  ///< of its lowest bit in the signal
};

/// Calls `visit(Piece)` for each byte that the signal touches.
template <typename Visit>
void for_each_piece(const CanSignal& signal, Visit visit) {
    unsigned left = signal.length;
    if (signal.order == ByteOrder::kIntel) {
        unsigned bit = signal.start_bit;
        while (left > 0) {
            const unsigned shift = bit % 8;
            const unsigned width = std::min(8 - shift, left);
            visit(Piece{.byte = bit / 8, .shift = shift, .width = width, .place = signal.length - left});
            bit += width;
            left -= width;
        }
        return;
    }
    std::size_t byte = signal.start_bit / 8U;
    unsigned above = signal.start_bit % 8U + 1;  // bits of this byte from bit 0 up to the signal's
    while (left > 0) {
        const unsigned width = std::min(above, left);
        left -= width;
        visit(Piece{.byte = byte, .shift = above - width, .width = width, .place = left});
        above = 8;
        ++byte;
    }
}

std::uint64_t clamped_integer(const CanSignal& signal, double scaled) {
    const bool is_signed = signal.type == SignalType::kSigned;
    // Powers of two, exact in a double; the highest value itself is not, beyond 53 bits.
    const double beyond = static_cast<double>(std::uint64_t{1} << (signal.length - 1U)) * (is_signed ? 1.0 : 2.0);
    const double rounded = std::round(scaled);
    if (rounded >= beyond) {
        return is_signed ? ones(signal.length - 1U) : ones(signal.length);
    }
    if (is_signed) {
        const auto whole = static_cast<std::int64_t>(std::max(rounded, -beyond));
        return static_cast<std::uint64_t>(whole) & ones(signal.length);
    }
    return static_cast<std::uint64_t>(std::max(rounded, 0.0));
}

}  // namespace

bool fits(const CanSignal& signal, std::size_t bytes) {
    if (signal.length < 1 || signal.length > 64 || (signal.type == SignalType::kFloat32 && signal.length != 32) ||
        (signal.type == SignalType::kFloat64 && signal.length != 64)) {
        return false;
    }
    const std::size_t first = signal.order == ByteOrder::kIntel
                                  ? signal.start_bit
                                  : 8U * (signal.start_bit / 8U) + 7U - signal.start_bit % 8U;
    return first + signal.length <= 8 * bytes;
}

std::uint64_t extract_bits(const CanSignal& signal, std::span<const std::uint8_t> payload) {
    std::uint64_t raw = 0;
    for_each_piece(signal, [&](const Piece& piece) {
        raw |= ((std::uint64_t{payload[piece.byte]} >> piece.shift) & ones(piece.width)) << piece.place;
    });
    return raw;
}

void insert_bits(const CanSignal& signal, std::span<std::uint8_t> payload, std::uint64_t raw) {
    for_each_piece(signal, [&](const Piece& piece) {
        const std::uint64_t mask = ones(piece.width) << piece.shift;
        const std::uint64_t bits = ((raw >> piece.place) << piece.shift) & mask;
        payload[piece.byte] = static_cast<std::uint8_t>((payload[piece.byte] & ~mask) | bits);
    });
}

double value_of(const CanSignal& signal, std::uint64_t raw) {
    double number = 0.0;
    switch (signal.type) {
        case SignalType::kUnsigned: number = static_cast<double>(raw); break;
        case SignalType::kSigned: {
            const std::uint64_t sign = std::uint64_t{1} << (signal.length - 1U);
            number = static_cast<double>(static_cast<std::int64_t>((raw ^ sign) - sign));
            break;
        }
        case SignalType::kFloat32:
            number = static_cast<double>(std::bit_cast<float>(static_cast<std::uint32_t>(raw)));
            break;
        case SignalType::kFloat64: number = std::bit_cast<double>(raw); break;
    }
    return number * signal.factor + signal.offset;
}

std::optional<std::uint64_t> bits_of(const CanSignal& signal, double value) {
    const bool is_float = signal.type == SignalType::kFloat32 || signal.type == SignalType::kFloat64;
    if (!(signal.factor < 0.0 || signal.factor > 0.0) || (std::isnan(value) && !is_float)) {
        return std::nullopt;
    }
    // A NaN passes both comparisons of clamp() unchanged.
    const double held = signal.minimum < signal.maximum ? std::clamp(value, signal.minimum, signal.maximum) : value;
    const double scaled = (held - signal.offset) / signal.factor;
    if (signal.type == SignalType::kFloat32) {
        return std::bit_cast<std::uint32_t>(static_cast<float>(scaled));
    }
    if (signal.type == SignalType::kFloat64) {
        return std::bit_cast<std::uint64_t>(scaled);
    }
    return clamped_integer(signal, scaled);
}

std::optional<double> decode(const CanSignal& signal, std::span<const std::uint8_t> payload) {
    if (!fits(signal, payload.size())) {
        return std::nullopt;
    }
    return value_of(signal, extract_bits(signal, payload));
}

bool encode(const CanSignal& signal, std::span<std::uint8_t> payload, double value) {
    if (!fits(signal, payload.size())) {
        return false;
    }
    const std::optional<std::uint64_t> raw = bits_of(signal, value);
    if (raw) {
        insert_bits(signal, payload, *raw);
    }
    return raw.has_value();
}

}  // namespace crspf
