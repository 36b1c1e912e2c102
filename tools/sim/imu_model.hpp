// What an IMU on the vehicle feels.
#pragma once

#include "core/odometry/attitude.hpp"
#include "tools/sim/terrain.hpp"

namespace crspf::sim {

/// In the vehicle's axes, x forward, y left, z up: means over the time since the sample before.
struct ImuRecord {
    Vector3 rate_radps;
    Vector3 force_mps2{.x = 0.0, .y = 0.0, .z = 9.80665};  ///< gravity is felt as an acceleration upward
};

/// Without errors; those are the bus's.
class ImuModel {
 public:
    /// @param start where the vehicle stands at first
    explicit ImuModel(const Frame& start) : before_(start) {}

    /// The vehicle moved on, within `seconds`.
    ImuRecord update(const Frame& now, double seconds);

 private:
    Frame before_;
    Vector3 velocity_mps_;
};

}  // namespace crspf::sim
