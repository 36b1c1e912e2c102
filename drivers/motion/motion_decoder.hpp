// Datagrams of another process's odometry -> increments of motion.
#pragma once

#include <cstdint>
#include <optional>
#include <span>

#include "core/base/samples.hpp"
#include "core/base/time.hpp"
#include "drivers/motion/motion_codec.hpp"

namespace crspf {

/// However slow the odometer's machine is: an age beyond this is a mistake.
inline constexpr Duration kMotionAgeMax{10'000'000'000};

/// Each datagram is counted once: as a sample, or by why it is none. Never reset.
struct MotionCounters {
    std::uint64_t samples = 0;
    std::uint64_t bad_length = 0;
    std::uint64_t bad_magic = 0;
    std::uint64_t bad_version = 0;  ///< or bits that this version leaves at 0
    std::uint64_t bad_crc = 0;
    std::uint64_t bad_age = 0;     ///< below 0, or above kMotionAgeMax
    std::uint64_t not_finite = 0;  ///< NaN, infinite, or a heading of more than 1e6 rad
    std::uint64_t ran_back =
        0;  ///< twice, overtaken by a later one, or of no later an instant; the next has its motion

    // Of the samples:
    std::uint64_t blind = 0;        ///< the odometer measured nothing
    std::uint64_t restarts = 0;     ///< the sender began anew: no motion
    std::uint64_t implausible = 0;  ///< more than 10 m at once, or a sum of variances that fell: no motion
    std::uint64_t lost = 0;         ///< datagrams missing before one; it has their motion
};

/// The first datagram, and the first of each session, is where the sender begins: a sample without a motion. The stamp
/// is that of the reception, less the age. Wait-free, no heap, no throw; one owner.
class MotionDecoder {
 public:
    std::optional<MotionSample> on_datagram(std::span<const std::uint8_t> payload, Stamp received);

    /// End of the first of the newest samples without sight; none: the newest saw, or there is none.
    [[nodiscard]] const std::optional<Stamp>& blind_since() const { return blind_since_; }
    [[nodiscard]] const MotionCounters& counters() const { return counters_; }

 private:
    [[nodiscard]] bool usable(const MotionDatagram& datagram);
    void move(const MotionDatagram& to, MotionSample& sample);

    std::optional<MotionDatagram> before_;
    Stamp stamp_;  ///< of the sample before
    std::optional<Stamp> blind_since_;
    MotionCounters counters_;
};

}  // namespace crspf
