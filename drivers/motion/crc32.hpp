// CRC-32 of IEEE 802.3 and zlib: polynomial 0xEDB88320 reflected, begins and ends inverted; 0xCBF43926 over the text
// 123456789.
#pragma once

#include <cstdint>
#include <span>

namespace crspf {

[[nodiscard]] constexpr std::uint32_t crc32(std::span<const std::uint8_t> bytes) {
    std::uint32_t rest = 0xFFFFFFFFU;
    for (const std::uint8_t byte : bytes) {
        rest ^= byte;
        for (int bit = 0; bit < 8; ++bit) {
            rest = (rest & 1U) != 0 ? (rest >> 1U) ^ 0xEDB88320U : rest >> 1U;
        }
    }
    return ~rest;
}

}  // namespace crspf
