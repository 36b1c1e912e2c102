// What the odometry of another process says: a datagram <-> values. docs/motion-protocol.md describes it byte by byte.
// Pure functions, wait-free.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "core/base/pose.hpp"
#include "core/base/time.hpp"

namespace crspf {

inline constexpr std::size_t kMotionBytes = 68;  ///< UDP payload

/// Why a datagram was refused.
enum class MotionFault : std::uint8_t {
    kNone,
    kLength,
    kMagic,
    kVersion,  ///< another version, or bits that this one leaves at 0
    kCrc,
};

/// Pose and variances are sums since the sender's start, so that what is lost on the way loses neither motion nor
/// doubt.
struct MotionDatagram {
    bool blind = false;                    ///< the odometer measured nothing: the motion is what it predicts
    std::uint32_t session = 0;             ///< another with each start of the sender
    std::uint32_t sequence = 0;            ///< one more, mod 2^32, with each datagram
    Duration age;                          ///< [ns] from the motion's end to the sending: no clock is shared
    Pose2 P_odom_base;                     ///< base_link in the sender's odometry frame
    double translation_variance_m2 = 0.0;  ///< [m^2] along and across, each
    double rotation_variance_rad2 = 0.0;   ///< [rad^2]

    friend bool operator==(const MotionDatagram&, const MotionDatagram&) = default;
};

/// Fills `out`; after a fault it holds nothing of use. Numbers may be of any kind, NaN included.
[[nodiscard]] MotionFault decode(std::span<const std::uint8_t> payload, MotionDatagram& out);

/// Bytes written: kMotionBytes, or 0 where they do not fit.
std::size_t encode(const MotionDatagram& motion, std::span<std::uint8_t> out);

}  // namespace crspf
