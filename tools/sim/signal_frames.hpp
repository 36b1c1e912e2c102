// Frames of a bus out of the values of its signals: what drivers/can understands, the other way round.
#pragma once

#include <cstdint>
#include <functional>
#include <string_view>
#include <vector>

#include "core/base/can_frame.hpp"
#include "drivers/can/signal_binding.hpp"
#include "drivers/can/wheel_decoder.hpp"

namespace crspf::sim {

class SignalFrames {
 public:
    /// @param dbc describes the messages of the bindings
    SignalFrames(std::string_view dbc, const std::vector<SignalBinding>& bindings);

    /// What the role says [in its unit], valid. A field without a sign gets the magnitude; what it cannot hold is held
    /// at its end.
    void set(const SignalBinding& binding, double value);
    /// The signal's bits, in each frame that carries it.
    void set_bits(const FrameSignal& signal, std::uint64_t bits);

    /// Hands out each frame as it stands; their alive counters go on by one.
    void send(const std::function<void(const CanFrame&)>& put);

 private:
    std::vector<CanFrame> frames_;       ///< one for each message, and value of its selector
    std::vector<FrameSignal> counters_;  ///< alive counters
    std::uint64_t alive_ = 0;
};

/// One wheel, as its binding has it told.
class WheelSignal {
 public:
    explicit WheelSignal(const WheelBinding& binding) : binding_(binding) {}

    /// @param way_m rolled since the beginning, backwards negative
    void tell(double way_m, double speed_mps, SignalFrames& frames);

 private:
    WheelBinding binding_;
    std::int64_t position_ = 0;  ///< in values of the counter
    std::int64_t counted_ = 0;   ///< the same, or where the direction stands beside it, both ways added
};

}  // namespace crspf::sim
