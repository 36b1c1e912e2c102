// The two datagrams of a Velodyne sensor: values <-> bytes. Pure functions, wait-free.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "drivers/velodyne/velodyne_models.hpp"

namespace crspf {

inline constexpr std::size_t kVelodyneDataBytes = 1206;     ///< UDP payload, port 2368
inline constexpr std::size_t kVelodynePositionBytes = 512;  ///< UDP payload, port 8308
inline constexpr std::uint32_t kVelodyneHour_us = 3600000000U;
inline constexpr std::int32_t kVelodyneTurn_cdeg = 36000;

inline constexpr std::uint8_t kVelodyneStrongest = 0x37;
inline constexpr std::uint8_t kVelodyneLast = 0x38;
inline constexpr std::uint8_t kVelodyneDual = 0x39;

/// Why a datagram was refused.
enum class VelodyneFault : std::uint8_t {
    kNone,
    kLength,
    kFlag,      ///< a block's flag is none of this model's, or the banks do not alternate
    kAzimuth,   ///< not below 36000, two blocks of one firing differ, or a turn no sensor makes between two blocks
    kStamp,     ///< not within the hour
    kMode,      ///< neither strongest, last nor dual; an HDL-64E in dual mode, whose packets are not known here
    kModel,     ///< the packet names another model than the configured one
    kPps,       ///< position packet: no such state
    kSentence,  ///< position packet: a sentence that is no GPRMC, or whose checksum does not hold
};

/// Two columns of a 16 laser sensor, one of a 32 laser sensor, a bank of the HDL-64E (even: upper, odd: lower). A
/// struct of arrays, as the geometry takes them.
struct VelodyneBlock {
    std::uint16_t azimuth_cdeg = 0;  ///< [0.01 deg] clockwise seen from above, 0 is the sensor's y axis, forward
    std::array<std::uint16_t, kVelodyneReturns> distance{};  ///< in VelodyneTraits::distance_unit_m; 0: no return
    std::array<std::uint8_t, kVelodyneReturns> reflectivity{};

    friend constexpr bool operator==(const VelodyneBlock&, const VelodyneBlock&) = default;
};

struct VelodynePacket {
    std::array<VelodyneBlock, kVelodyneBlocks> blocks{};
    std::uint32_t stamp_us = 0;  ///< [us] since the top of the sensor's hour
    std::uint8_t mode = 0;       ///< return mode; HDL-64E: type of the status byte
    std::uint8_t product = 0;    ///< product; HDL-64E: value of the status byte

    friend constexpr bool operator==(const VelodynePacket&, const VelodynePacket&) = default;
};

/// With two returns, blocks come in pairs of one azimuth: the last return first, then the strongest. A pair whose two
/// returns are one holds it twice.
[[nodiscard]] constexpr bool is_dual(VelodyneModel model, const VelodynePacket& packet) {
    return !is_hdl64e(model) && packet.mode == kVelodyneDual;
}

/// Fills `out`; after a fault it holds nothing of use. Packets without mode and product, both 0, as HDL-32E of old
/// send them, are taken for single returns.
[[nodiscard]] VelodyneFault decode(std::span<const std::uint8_t> payload, VelodyneModel model, VelodynePacket& out);

/// Bytes written: kVelodyneDataBytes, or 0 where they do not fit.
std::size_t encode(const VelodynePacket& packet, VelodyneModel model, std::span<std::uint8_t> out);

/// State of the pulse per second that disciplines the sensor's clock.
enum class VelodynePps : std::uint8_t { kNone, kSynchronising, kLocked, kError };

struct VelodynePosition {
    std::uint32_t stamp_us = 0;  ///< [us] since the top of the sensor's hour
    VelodynePps pps = VelodynePps::kNone;
    /// From '$' to the checksum, without the end of line; empty without GPS receiver. Points into the datagram.
    std::span<const std::uint8_t> sentence;
    bool fix = false;  ///< the receiver calls its time and place valid
};

[[nodiscard]] VelodyneFault decode(std::span<const std::uint8_t> payload, VelodynePosition& out);

/// Bytes written: kVelodynePositionBytes, or 0 where they or the sentence do not fit.
std::size_t encode(const VelodynePosition& position, std::span<std::uint8_t> out);

}  // namespace crspf
