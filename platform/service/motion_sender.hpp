// An odometer's word on its way to crspfd, which is another process (docs/motion-protocol.md).
#pragma once

#include <array>
#include <cstdint>

#include "core/base/samples.hpp"
#include "drivers/motion/motion_codec.hpp"
#include "platform/files/unique_fd.hpp"

namespace crspf {

/// Never reset.
struct MotionSenderCounters {
    std::uint64_t sent = 0;
    std::uint64_t unsent = 0;   ///< the system took no datagram; the next one has its motion
    std::uint64_t refused = 0;  ///< samples that are no motion: not finite, or with variances below 0
};

/// send() never waits, allocates or throws. Whether anyone listens is not known. One owner.
class MotionSender {
 public:
    /// @param address IPv4, as a number: 0x7F000001 is this machine
    /// @param session another with each start: new_session()
    /// Throws InputError where the system gives no socket.
    MotionSender(std::uint32_t address, std::uint16_t port, std::uint32_t session);

    /// A number that hardly any other start has.
    [[nodiscard]] static std::uint32_t new_session();

    /// The motion since the sample before. Its stamp is on the monotonic clock.
    void send(const MotionSample& sample);

    [[nodiscard]] const MotionSenderCounters& counters() const { return counters_; }

 private:
    UniqueFd socket_;
    std::uint32_t address_;
    std::uint16_t port_;
    MotionDatagram sum_;
    MotionSenderCounters counters_;
};

}  // namespace crspf
