// CRC-8 SAE J1850: polynomial 0x1D, begins with 0xFF, inverted at the end; 0x4B over the text 123456789.
#pragma once

#include <cstdint>
#include <span>

namespace crspf {

/// @param crc what crc8_j1850() gave for the bytes before these, to go on
[[nodiscard]] constexpr std::uint8_t crc8_j1850(std::span<const std::uint8_t> bytes, std::uint8_t crc = 0) {
    unsigned rest = crc ^ 0xFFU;
    for (const std::uint8_t byte : bytes) {
        rest ^= byte;
        for (int bit = 0; bit < 8; ++bit) {
            rest = (rest & 0x80U) != 0 ? (rest << 1U) ^ 0x1DU : rest << 1U;
        }
        rest &= 0xFFU;
    }
    return static_cast<std::uint8_t>(rest ^ 0xFFU);
}

}  // namespace crspf
