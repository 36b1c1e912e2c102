// An LD06 that stands, for tests: turns clockwise 10 times a second, reads 4500 times a second, from its front on.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/base/time.hpp"
#include "core/base/trig.hpp"
#include "drivers/ldrobot/ld06_codec.hpp"

namespace crspf::test {

inline constexpr double kLd06Step_deg = 0.8;
inline constexpr double kLd06Reading_s = 1.0 / 4500.0;

/// What there is at an angle counter-clockwise from its front: a wall all round, nearer to the left; nothing behind.
inline double ld06_range_m(double angle_rad) {
    return std::abs(wrap_angle(angle_rad)) > radians(170.0) ? 0.0 : 3.0 - std::sin(angle_rad);
}

/// Since power-on. Packets are numbered from 0.
inline Stamp ld06_measured(std::uint64_t reading) {
    return {std::llround(1e9 * kLd06Reading_s * static_cast<double>(reading))};
}
/// When its last byte is on the line.
inline Stamp ld06_sent(std::uint64_t packet) {
    return ld06_measured(packet * kLd06Readings + kLd06Readings - 1) +
           Duration::from_seconds(10.0 * kLd06Bytes / kLd06Baud);
}

inline Ld06Packet ld06_packet(std::uint64_t number) {
    const auto angle_deg = [number](std::size_t i) {
        return std::fmod(kLd06Step_deg * static_cast<double>(number * kLd06Readings + i), 360.0);
    };
    const auto cdeg = [&](std::size_t i) {
        return static_cast<std::uint16_t>(std::lround(100.0 * angle_deg(i)) % kLd06Turn_cdeg);
    };
    Ld06Packet packet;
    packet.speed_degps = 3600;
    packet.first_cdeg = cdeg(0);
    packet.last_cdeg = cdeg(kLd06Readings - 1);
    packet.time_ms =
        static_cast<std::uint16_t>(ld06_measured(number * kLd06Readings).ns / 1'000'000 % kLd06TimeWrap_ms);
    for (std::size_t i = 0; i < kLd06Readings; ++i) {
        const double range_m = ld06_range_m(-radians(angle_deg(i)));
        packet.readings[i] = {.range_mm = static_cast<std::uint16_t>(std::lround(1000.0 * range_m)), .confidence = 200};
    }
    return packet;
}

inline std::array<std::uint8_t, kLd06Bytes> ld06_bytes(const Ld06Packet& packet) {
    std::array<std::uint8_t, kLd06Bytes> bytes{};
    static_cast<void>(encode_ld06(packet, bytes));
    return bytes;
}

}  // namespace crspf::test
