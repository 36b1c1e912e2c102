// The base of the simulated robot on its CAN bus: it says what a configuration has it say.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>

#include "config/config.hpp"
#include "core/base/can_frame.hpp"
#include "core/base/time.hpp"
#include "tools/sim/log_writer.hpp"
#include "tools/sim/random.hpp"
#include "tools/sim/signal_frames.hpp"
#include "tools/sim/simulation.hpp"

namespace crspf::sim {

class BaseBus {
 public:
    /// A frame, and when the host hears it.
    using Record = std::function<void(Stamp, const CanFrame&)>;

    /// @param bus has an odometer
    /// @param vehicle what its maker knows of it: the true motion is told so that this makes the truth of it again
    BaseBus(const CanSourceConfig& bus, const OdometryParams& vehicle, const SimulationParams& params, Record record);

    /// Power on: CANopen nodes are operational from now on and say so twice a second.
    void begin(Stamp now) { next_heartbeat_ = now; }
    /// Tells the odometry of `now`, which never falls; before it the heartbeats up to then.
    void send(Stamp now, const OdometryRecord& odometry);

 private:
    void set(const WheelParams& wheels, const OdometryRecord& odometry);
    void set(const AckermannParams& car, const OdometryRecord& odometry);
    void set(const ImuParams& imu, const OdometryRecord& odometry);
    void set(const std::monostate& /*nothing*/, const OdometryRecord& /*odometry*/) {}
    void set_speed(const SpeedBinding& speed, const OdometryRecord& odometry);
    void put(Stamp now, const CanFrame& frame);

    CanSourceConfig bus_;
    OdometryParams vehicle_;
    RobotParams robot_;
    double gyro_bias_radps_;
    Record record_;
    Random delays_;
    Random noise_;  ///< of the IMU
    SignalFrames frames_;
    std::optional<WheelSignal> left_;
    std::optional<WheelSignal> right_;
    Stamp next_heartbeat_;
    Stamp last_;  ///< reception of the frame before: frames do not overtake each other
};

}  // namespace crspf::sim
