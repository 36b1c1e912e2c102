// The base of the simulated robot on its CAN bus.
#pragma once

#include <cstdint>
#include <functional>
#include <string_view>

#include "core/base/can_frame.hpp"
#include "core/base/time.hpp"
#include "drivers/can/frame_signal.hpp"
#include "tools/sim/log_writer.hpp"
#include "tools/sim/random.hpp"

namespace crspf::sim {

/// MESSAGE.SIGNAL of a bus's own DBC text, which holds it.
[[nodiscard]] FrameSignal signal_of(std::string_view dbc, std::string_view dotted);

class BaseBus {
 public:
    /// A frame, and when the host hears it.
    using Record = std::function<void(Stamp, const CanFrame&)>;

    BaseBus(std::uint64_t seed, RandomStream stream, Record record);
    BaseBus(const BaseBus&) = delete;
    BaseBus& operator=(const BaseBus&) = delete;
    virtual ~BaseBus() = default;

    /// Power on.
    virtual void begin(Stamp now) = 0;
    /// Tells the odometry of `now`, which never falls.
    virtual void send(Stamp now, const OdometryRecord& odometry) = 0;

 protected:
    void put(Stamp now, const CanFrame& frame);
    [[nodiscard]] Random& random() { return random_; }

 private:
    Record record_;
    Random random_;
    Stamp last_;  ///< reception of the frame before: frames do not overtake each other
};

}  // namespace crspf::sim
