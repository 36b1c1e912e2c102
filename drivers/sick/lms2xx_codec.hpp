// Telegrams of the LMS200, LMS220 and LMS291 on a serial line.
//
// 02, address (00 to the sensor, 80 from it), u16 length, payload, u16 CRC, all little-endian; the payload's first byte
// is the command, a reply's is the request's + 80h, and its last is a status. Each request is first acknowledged by a
// lone 06, or refused by 15.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

namespace crspf {

inline constexpr std::size_t kLargestLms2xxPayload = 812;
inline constexpr std::size_t kLms2xxFrame = 6;
inline constexpr std::size_t kLargestLms2xxTelegram = kLargestLms2xxPayload + kLms2xxFrame;
inline constexpr std::size_t kLms2xxValues = 401;
inline constexpr std::uint8_t kLms2xxStart = 0x02;
inline constexpr std::uint8_t kLms2xxAck = 0x06;
inline constexpr std::uint8_t kLms2xxNack = 0x15;
inline constexpr std::uint8_t kLms2xxFromSensor = 0x80;

/// Over everything before it, header included. Start 0; the sensor's own polynomial arithmetic over pairs of bytes.
[[nodiscard]] std::uint16_t lms2xx_crc(std::span<const std::uint8_t> bytes);

/// Frames a payload. Returns the number of bytes written, 0 where they do not fit.
std::size_t encode_lms2xx(std::uint8_t address, std::span<const std::uint8_t> payload, std::span<std::uint8_t> out);

/// The second byte of command 20h.
enum class Lms2xxMode : std::uint8_t {
    kInstallation = 0x00,  ///< with the password
    kStreamAll = 0x24,
    kOnRequest = 0x25,
    kBaud38400 = 0x40,
    kBaud19200 = 0x41,
    kBaud9600 = 0x42,
    kBaud500000 = 0x48,
};

/// Field of view and resolution. The sensor knows 100 or 180 degrees by 1, 0.5 or (100 only) 0.25.
struct Lms2xxVariant {
    std::uint16_t angle_deg = 180;       ///< [degree]
    std::uint16_t resolution_cdeg = 50;  ///< [0.01 degree]
    friend bool operator==(const Lms2xxVariant&, const Lms2xxVariant&) = default;
};

std::size_t encode_lms2xx_mode(Lms2xxMode mode, std::span<std::uint8_t> out);
std::size_t encode_lms2xx_variant(const Lms2xxVariant& variant, std::span<std::uint8_t> out);
std::size_t encode_lms2xx_status_request(std::span<std::uint8_t> out);

/// The command 20h for a line's speed. False for a speed that the sensor does not know.
[[nodiscard]] bool mode_of_baud(std::uint32_t baud, Lms2xxMode& mode);

/// The first byte of a reply that holds a scan.
inline constexpr std::uint8_t kLms2xxScanReply = 0xB0;

/// Reply B0h: one scan.
struct Lms2xxScan {
    enum class Unit : std::uint8_t { kCentimetre = 0, kMillimetre = 1 };
    Unit unit = Unit::kCentimetre;
    bool partial = false;            ///< whole degrees only, begun partial_index quarters of a degree later
    std::uint8_t partial_index = 0;  ///< 0 to 3
    std::uint16_t count = 0;
    std::array<std::uint16_t, kLms2xxValues> values{};  ///< raw, with the flags of the measuring mode
    std::uint8_t indices = 0;                           ///< how many bytes of real-time and telegram index follow
    std::array<std::uint8_t, 2> index{};
    std::uint8_t status = 0;
};

/// False where the payload is no scan, or its length does not fit its count.
[[nodiscard]] bool decode_lms2xx_scan(std::span<const std::uint8_t> payload, Lms2xxScan& scan);
std::size_t encode_lms2xx_scan(const Lms2xxScan& scan, std::span<std::uint8_t> payload);

/// The variant that gives that many values; false where none does.
[[nodiscard]] bool variant_of_count(std::uint16_t count, Lms2xxVariant& variant);

}  // namespace crspf
