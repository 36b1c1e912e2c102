// The sensor's clock on the host's line.
#pragma once

#include <cstdint>

#include "core/base/time.hpp"

namespace crspf {

/// The instant nearest to `near` at which a clock that starts anew each hour shows `stamp_us`. It is the sensor's own
/// time where `near` is the host's UTC and the sensor has a GPS receiver.
[[nodiscard]] Stamp resolve_hour(std::uint32_t stamp_us, Stamp near);

/// Finds the offset between the sensor's clock, which knows no hour and may start at power-on, and the line of the
/// host's receive stamps. A datagram is never early: the offset follows the earliest ones at once and the later ones by
/// no more than the drift of a quartz, so that waiting in the network or the host does not shake the stamps.
/// Wait-free. One owner.
class VelodyneClock {
 public:
    /// Learns from one datagram, which was complete so long after its stamp.
    void observe(std::uint32_t stamp_us, Duration complete, Stamp received);

    /// Lets at() follow what was learnt meanwhile. Called between revolutions, so that within one the stamps are the
    /// sensor's own, however the receive stamps tremble; after a step, and at first, it is done at once.
    void adopt() { used_offset_ = offset_; }

    /// The host's stamp of an instant of the sensor's clock within half an hour of the datagram observed last.
    [[nodiscard]] Stamp at(std::uint32_t stamp_us) const;

    /// Jumps by more than half a second: the sensor was restarted, or its GPS receiver set its clock.
    [[nodiscard]] std::uint32_t steps() const { return steps_; }

 private:
    bool known_ = false;
    Duration offset_;  ///< host minus sensor, as learnt
    Duration used_offset_;
    Stamp received_;  ///< of the datagram observed last
    std::uint32_t steps_ = 0;
};

}  // namespace crspf
