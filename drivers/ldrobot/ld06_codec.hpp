// Packets of the LD06, LD19 and their kin by LDROBOT ("LD06 Development Manual", "LD19 Development Manual"): 12
// readings of a lidar that speaks from power-on and does not listen. 230400 baud, 8N1.
//
// 54, 2C (packet of 12 readings), u16 speed [deg/s], u16 angle of the first reading [0.01 deg], 12 times u16 range [mm]
// and u8 confidence, u16 angle of the last one, u16 time [ms], which wraps at 30000, u8 CRC; all little-endian. Angles
// grow clockwise seen from above; 0 is the sensor's front.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

namespace crspf {

inline constexpr std::uint32_t kLd06Baud = 230'400;
inline constexpr std::size_t kLd06Bytes = 47;
inline constexpr std::size_t kLd06Readings = 12;
inline constexpr std::uint8_t kLd06Start = 0x54;
inline constexpr std::uint8_t kLd06Kind = 0x2C;
inline constexpr std::uint16_t kLd06TimeWrap_ms = 30'000;
inline constexpr std::uint16_t kLd06Turn_cdeg = 36'000;

struct Ld06Reading {
    std::uint16_t range_mm = 0;  ///< 0: nothing was seen
    std::uint8_t confidence = 0;
    friend bool operator==(const Ld06Reading&, const Ld06Reading&) = default;
};

struct Ld06Packet {
    std::uint16_t speed_degps = 0;
    std::uint16_t first_cdeg = 0;  ///< [0.01 degree] clockwise, of the first reading
    std::array<Ld06Reading, kLd06Readings> readings{};
    std::uint16_t last_cdeg = 0;  ///< the same of the last one
    std::uint16_t time_ms = 0;    ///< the sensor's, below kLd06TimeWrap_ms
    friend bool operator==(const Ld06Packet&, const Ld06Packet&) = default;
};

/// Over everything before it: polynomial 0x4D, begins with 0.
[[nodiscard]] std::uint8_t ld06_crc(std::span<const std::uint8_t> bytes);

/// False where the bytes are no packet, or their CRC is wrong.
[[nodiscard]] bool decode_ld06(std::span<const std::uint8_t> bytes, Ld06Packet& packet);

/// The number of bytes written; 0 where they do not fit.
std::size_t encode_ld06(const Ld06Packet& packet, std::span<std::uint8_t> out);

/// [0.01 degree] from a reading to the next, times kLd06Readings - 1.
[[nodiscard]] constexpr unsigned ld06_span_cdeg(const Ld06Packet& packet) {
    return (unsigned{packet.last_cdeg} + kLd06Turn_cdeg - packet.first_cdeg) % kLd06Turn_cdeg;
}

/// Whether a sensor of this kind can have meant it: 1 to 20 turns a second, readings 0.2 to 3 degrees apart.
[[nodiscard]] bool is_plausible(const Ld06Packet& packet);

}  // namespace crspf
