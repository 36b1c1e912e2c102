// A CAN bus, as the owner of a driver sees it.
#pragma once

#include <cstdint>

#include "core/base/can_frame.hpp"
#include "platform/ports/io_result.hpp"

namespace crspf {

/// Fault confinement of ISO 11898-1, by the controller's error counters.
enum class CanState : std::uint8_t {
    kActive,   ///< below 96
    kWarning,  ///< 96 to 127
    kPassive,  ///< 128 to 255: it may no longer destroy others' faulty frames
    kBusOff,   ///< 256: neither sends nor receives until it is restarted
};

/// Counters never fall.
struct CanHealth {
    CanState state = CanState::kActive;
    std::uint8_t transmit_errors = 0;  ///< the controller's counter, as it last told
    std::uint8_t receive_errors = 0;
    std::uint64_t bus_offs = 0;
    std::uint64_t restarts = 0;
    std::uint64_t bus_errors = 0;     ///< protocol violations, missing acknowledgements, transceiver faults
    std::uint64_t overflows = 0;      ///< of the controller's buffers
    std::uint64_t dropped = 0;        ///< frames lost in the system's receive queue
    std::uint64_t send_timeouts = 0;  ///< frames given up at their deadline
    std::uint64_t queue_full = 0;     ///< times the system's transmit queue had no room
    std::uint64_t interface_downs = 0;
};

/// One thread's. No call throws, allocates or waits longer than it is told to; a loop over receive() with a wait never
/// spins.
class CanBus {
 public:
    virtual ~CanBus() = default;
    /// One frame of the bus, after waiting up to `wait` for it. Error frames go into health().
    [[nodiscard]] virtual Received receive(CanFrame& frame, Duration wait) = 0;
    /// Tries until `deadline` on the monotonic clock, then gives the frame up with kRetry: old news must not clog the
    /// bus. kError for a frame that a bus cannot carry.
    [[nodiscard]] virtual IoStatus send(const CanFrame& frame, Stamp deadline) = 0;
    [[nodiscard]] virtual const CanHealth& health() const = 0;
    /// Why it is closed: the number of the system's error; 0: nothing went wrong yet.
    [[nodiscard]] virtual int error() const = 0;
};

}  // namespace crspf
