// The two driven wheels of a robot, from whatever its bus says about them, as DifferentialSamples.
#pragma once

#include <cstdint>
#include <optional>

#include "core/base/samples.hpp"
#include "drivers/can/signal_binding.hpp"

namespace crspf {

/// One wheel. The binding's role is a position counter [m per value, in `scale` times the DBC's factor] or, where
/// `is_speed`, a rolling speed [m/s].
struct WheelBinding {
    SignalBinding signal;
    bool is_speed = false;
    std::uint64_t modulus = 0;  ///< values of the counter, where it wraps before its width does; 0: the width's
    std::optional<FrameSignal> direction{};  ///< in the same frame, for counters that only count up
    std::uint64_t backward_bits = 1;         ///< of `direction` while rolling backward
};

struct WheelParams {
    WheelBinding left;
    WheelBinding right;
    double speed_max_mps = 3.0;  ///< [m/s] of a wheel. What says more is a jump: a drive that was reset
    /// [ns] Values of the two wheels that came within this belong together; half the period between them, or less.
    Duration pair_within{.ns = 5'000'000};
};

/// Whether the way since the value before is told without doubt up to the binding's timeout: at `speed_max_mps` the
/// counter goes less than half round in twice that time. Where it is not, choose a shorter timeout; nothing but
/// restarts would come of it. To be asked when the configuration is read.
[[nodiscard]] bool unambiguous(const WheelBinding& wheel, double speed_max_mps);

/// What did not become a sample. Never reset. See also the two wheels' BindingCounters.
struct WheelCounters {
    std::uint64_t samples = 0;
    std::uint64_t jumps = 0;  ///< faster than speed_max_mps
    std::uint64_t restarts =
        0;  ///< after a silence in which the counter may have gone round: what it rolled is not known
    std::uint64_t unpaired =
        0;  ///< a wheel's value without one of the other wheel in time; its way goes to the next pair
};

/// Distances add up until both wheels have spoken, so that a lost frame loses no way. Only a jump or restart does: then
/// of both wheels, because one wheel's way alone would be a turn. Wait-free, no heap, no throw; one owner.
class WheelDecoder {
 public:
    explicit WheelDecoder(const WheelParams& params);

    /// Feed every frame of the bus. A sample's stamp is that of the later of its two frames' receptions.
    std::optional<DifferentialSample> on_frame(const CanFrame& frame, Stamp received);
    void on_time(Stamp now);

    [[nodiscard]] bool fresh(Stamp now) const { return left_.signal.fresh(now) && right_.signal.fresh(now); }
    [[nodiscard]] const WheelCounters& counters() const { return counters_; }
    [[nodiscard]] const BindingCounters& left_counters() const { return left_.signal.counters(); }
    [[nodiscard]] const BindingCounters& right_counters() const { return right_.signal.counters(); }

 private:
    struct Wheel {
        explicit Wheel(const WheelBinding& from);

        WheelBinding binding;
        BoundSignal signal;
        std::uint64_t modulus;   ///< of the counter; 0 is 2^64
        bool known = false;      ///< there is a value before
        std::uint64_t raw = 0;   ///< the value before
        Stamp stamp;             ///< its reception
        double pending_m = 0.0;  ///< rolled since the last sample
        bool waiting = false;    ///< has spoken since the last sample
    };

    void forget();
    bool on_wheel(Wheel& wheel, const CanFrame& frame, Stamp received);
    [[nodiscard]] std::optional<double> rolled(Wheel& wheel, std::uint64_t raw, double direction, double dt_s);

    WheelParams params_;
    Wheel left_;
    Wheel right_;
    WheelCounters counters_;
};

}  // namespace crspf
