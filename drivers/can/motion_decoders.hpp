// Speed with steering, or yaw rate with speed or without, from whatever the vehicle's bus says about them.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>

#include "core/base/samples.hpp"
#include "drivers/can/signal_binding.hpp"

namespace crspf {

/// Vehicle speed from one signal, or as the mean of two, such as both rear wheels'. [m/s] forward positive
struct SpeedBinding {
    SignalBinding signal;
    std::optional<SignalBinding> second;
};

/// Never reset. See also the signals' BindingCounters.
struct MotionDecoderCounters {
    std::uint64_t samples = 0;
    std::uint64_t incomplete = 0;  ///< a frame came while another signal had not been heard, or was silent
};

/// The speed that was heard last. Wait-free, no heap, no throw.
class HeldSpeed {
 public:
    explicit HeldSpeed(const SpeedBinding& binding);

    /// Whether the frame told something about the speed.
    bool on_frame(const CanFrame& frame, Stamp received);
    void on_time(Stamp now);
    [[nodiscard]] bool fresh(Stamp now) const { return first_.fresh(now) && (!second_ || second_->fresh(now)); }
    [[nodiscard]] double speed_mps() const { return second_ ? (first_mps_ + second_mps_) / 2.0 : first_mps_; }
    [[nodiscard]] const BindingCounters& counters() const { return first_.counters(); }
    /// Of the second signal, where there is one.
    [[nodiscard]] const BindingCounters* second_counters() const { return second_ ? &second_->counters() : nullptr; }

 private:
    BoundSignal first_;
    std::optional<BoundSignal> second_;
    double first_mps_ = 0.0;
    double second_mps_ = 0.0;
};

struct AckermannParams {
    SpeedBinding speed;
    SignalBinding steering;          ///< [rad] left positive, of the wheels: `scale` holds the steering gear's ratio
    double steering_zero_rad = 0.0;  ///< [rad] what the signal says straight ahead; taken off
};

/// A sample for each frame that says something about either, once both are known. Wait-free, no heap, no throw.
class AckermannDecoder {
 public:
    explicit AckermannDecoder(const AckermannParams& params);

    /// Feed every frame of the bus.
    std::optional<AckermannSample> on_frame(const CanFrame& frame, Stamp received);
    void on_time(Stamp now);

    [[nodiscard]] bool fresh(Stamp now) const { return speed_.fresh(now) && steering_.fresh(now); }
    [[nodiscard]] const MotionDecoderCounters& counters() const { return counters_; }
    [[nodiscard]] const HeldSpeed& speed() const { return speed_; }
    [[nodiscard]] const BindingCounters& steering_counters() const { return steering_.counters(); }

 private:
    HeldSpeed speed_;
    BoundSignal steering_;
    double steering_zero_rad_;
    double steering_rad_ = 0.0;
    MotionDecoderCounters counters_;
};

/// The other five axes of an IMU, in the vehicle's (REP-103). A sensor that is mounted another way is turned by the
/// choice of its signals and the signs of their `scale`.
struct InertialBinding {
    SignalBinding roll_rate;       ///< [rad/s]
    SignalBinding pitch_rate;      ///< [rad/s]
    SignalBinding acceleration_x;  ///< [m/s^2] specific force: standing on level ground, z is 9.81
    SignalBinding acceleration_y;  ///< [m/s^2]
    SignalBinding acceleration_z;  ///< [m/s^2]
};

struct ImuParams {
    std::optional<SpeedBinding> speed;  ///< none: the samples say that nobody tells it
    SignalBinding yaw_rate;  ///< [rad/s] counter-clockwise positive: a sensor mounted on edge or upside down is
                             ///< turned round by the choice of its signal and the sign of `scale`
    double yaw_rate_bias_radps = 0.0;  ///< [rad/s] what the signal says standing still; taken off
    std::optional<InertialBinding> inertial{};
};

/// The axes that were heard last. Wait-free, no heap, no throw.
class HeldInertial {
 public:
    explicit HeldInertial(const InertialBinding& binding);

    void on_frame(const CanFrame& frame, Stamp received);
    void on_time(Stamp now);
    [[nodiscard]] bool fresh(Stamp now) const;
    [[nodiscard]] const Inertial& value() const { return value_; }
    [[nodiscard]] std::span<const BoundSignal> signals() const { return signals_; }

 private:
    std::array<BoundSignal, 5> signals_;  ///< in the order of Inertial's fields
    Inertial value_;
};

/// A sample for each yaw rate, with the speed, where there is one, and the other axes that were heard last; without
/// these axes where one is silent. Wait-free, no heap, no throw.
class ImuDecoder {
 public:
    explicit ImuDecoder(const ImuParams& params);

    /// Feed every frame of the bus.
    std::optional<ImuSample> on_frame(const CanFrame& frame, Stamp received);
    void on_time(Stamp now);

    [[nodiscard]] bool fresh(Stamp now) const { return (!speed_ || speed_->fresh(now)) && yaw_rate_.fresh(now); }
    [[nodiscard]] const MotionDecoderCounters& counters() const { return counters_; }
    [[nodiscard]] const std::optional<HeldSpeed>& speed() const { return speed_; }
    [[nodiscard]] const BindingCounters& yaw_rate_counters() const { return yaw_rate_.counters(); }
    [[nodiscard]] const std::optional<HeldInertial>& inertial() const { return inertial_; }

 private:
    std::optional<HeldSpeed> speed_;
    BoundSignal yaw_rate_;
    std::optional<HeldInertial> inertial_;
    double bias_radps_;
    MotionDecoderCounters counters_;
};

}  // namespace crspf
