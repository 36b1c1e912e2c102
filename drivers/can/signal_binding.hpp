// A role of the odometry, such as the left wheel's counter, bound to a signal of some vehicle's bus, with the checks
// that the vehicle offers: validity bit, alive counter, silence.
#pragma once

#include <cstdint>
#include <optional>

#include "core/base/can_frame.hpp"
#include "core/base/time.hpp"
#include "drivers/can/frame_signal.hpp"

namespace crspf {

struct SignalBinding {
    FrameSignal signal{};
    double scale = 1.0;  ///< from the DBC's unit to the role's: 1 / 3.6 for km/h; negative turns it round
    Duration timeout{.ns = 500'000'000};    ///< [ns] without a good frame: silent
    std::optional<FrameSignal> validity{};  ///< in the same frame: usable only while its bits are `valid_bits`
    std::uint64_t valid_bits = 1;
    std::optional<FrameSignal>
        alive{};  ///< in the same frame: a counter that goes up by one each time, round its width
};

/// What was not used, and why. Never reset.
struct BindingCounters {
    std::uint64_t frames = 0;        ///< with the signal's id
    std::uint64_t absent = 0;        ///< too short for the signal, or the selector chose others
    std::uint64_t invalid = 0;       ///< the vehicle said so, or not a finite number
    std::uint64_t alive_stuck = 0;   ///< the alive counter stood: not used
    std::uint64_t alive_jumped = 0;  ///< frames were missing before this one: used
    std::uint64_t timeouts = 0;      ///< silences, each counted once
};

/// Watches one binding. Wait-free, no heap, no throw; one owner.
class BoundSignal {
 public:
    explicit BoundSignal(const SignalBinding& binding) : binding_(binding) {}

    /// The signal's bits, where the frame carries them and every check passes. Frames of other ids cost a comparison.
    std::optional<std::uint64_t> on_frame(const CanFrame& frame, Stamp received);
    /// To be called now and then, so that a silence is seen although no frame comes.
    void on_time(Stamp now);

    /// In the role's unit. [as the decoder that uses it says]
    [[nodiscard]] double value(std::uint64_t raw) const {
        return value_of(binding_.signal.layout, raw) * binding_.scale;
    }
    /// A good frame came within the timeout.
    [[nodiscard]] bool fresh(Stamp now) const { return heard_ && now - last_ <= binding_.timeout; }
    [[nodiscard]] const SignalBinding& binding() const { return binding_; }
    [[nodiscard]] const BindingCounters& counters() const { return counters_; }

 private:
    [[nodiscard]] bool alive_moved(const CanFrame& frame);

    SignalBinding binding_;
    BindingCounters counters_;
    Stamp last_;  ///< of the last good frame
    bool heard_ = false;
    bool silent_ = false;
    std::optional<std::uint64_t> alive_before_;
};

/// How far a counter went from `before` to `now`, the short way round: in [-modulus / 2, modulus / 2).
/// @param modulus how many values the counter has, all of 64 bits where 0; before, now < modulus
[[nodiscard]] std::int64_t counted(std::uint64_t before, std::uint64_t now, std::uint64_t modulus);

}  // namespace crspf
