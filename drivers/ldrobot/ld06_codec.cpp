#include "drivers/ldrobot/ld06_codec.hpp"

#include "drivers/common/byte_reader.hpp"
#include "drivers/common/byte_writer.hpp"

namespace crspf {

std::uint8_t ld06_crc(std::span<const std::uint8_t> bytes) {
    unsigned rest = 0;
    for (const std::uint8_t byte : bytes) {
        rest ^= byte;
        for (int bit = 0; bit < 8; ++bit) {
            rest = (rest & 0x80U) != 0 ? (rest << 1U) ^ 0x4DU : rest << 1U;
        }
        rest &= 0xFFU;
    }
    return static_cast<std::uint8_t>(rest);
}

bool decode_ld06(std::span<const std::uint8_t> bytes, Ld06Packet& packet) {
    if (bytes.size() != kLd06Bytes || bytes[0] != kLd06Start || bytes[1] != kLd06Kind ||
        ld06_crc(bytes.first(kLd06Bytes - 1)) != bytes[kLd06Bytes - 1]) {
        return false;
    }
    ByteReader in(bytes.subspan(2));
    packet.speed_degps = in.little<std::uint16_t>();
    packet.first_cdeg = in.little<std::uint16_t>();
    for (Ld06Reading& reading : packet.readings) {
        reading.range_mm = in.little<std::uint16_t>();
        reading.confidence = in.byte();
    }
    packet.last_cdeg = in.little<std::uint16_t>();
    packet.time_ms = in.little<std::uint16_t>();
    return true;
}

std::size_t encode_ld06(const Ld06Packet& packet, std::span<std::uint8_t> out) {
    ByteWriter to(out);
    to.byte(kLd06Start);
    to.byte(kLd06Kind);
    to.little(packet.speed_degps);
    to.little(packet.first_cdeg);
    for (const Ld06Reading& reading : packet.readings) {
        to.little(reading.range_mm);
        to.byte(reading.confidence);
    }
    to.little(packet.last_cdeg);
    to.little(packet.time_ms);
    to.byte(ld06_crc(to.written()));
    return to.ok() ? to.position() : 0;
}

bool is_plausible(const Ld06Packet& packet) {
    constexpr unsigned kSlowest_degps = 360;
    constexpr unsigned kFastest_degps = 7200;
    constexpr unsigned kFinest_cdeg = 20 * (kLd06Readings - 1);
    constexpr unsigned kCoarsest_cdeg = 300 * (kLd06Readings - 1);
    const unsigned span_cdeg = ld06_span_cdeg(packet);
    return packet.speed_degps >= kSlowest_degps && packet.speed_degps <= kFastest_degps &&
           packet.first_cdeg < kLd06Turn_cdeg && packet.last_cdeg < kLd06Turn_cdeg && span_cdeg >= kFinest_cdeg &&
           span_cdeg <= kCoarsest_cdeg && packet.time_ms <= kLd06TimeWrap_ms;
}

}  // namespace crspf
