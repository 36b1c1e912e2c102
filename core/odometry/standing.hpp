// A vehicle that stands: what its gyroscope then says is the gyroscope's bias.
#pragma once

#include <algorithm>

#include "core/base/real.hpp"
#include "core/base/trig.hpp"

namespace crspf {

/// No gyroscope on a vehicle has a larger one. [rad/s]
inline constexpr double kGyroBiasMax_radps = radians(5.0);

[[nodiscard]] inline double clamped_gyro_bias(double bias_radps) {
    return std::clamp(bias_radps, -kGyroBiasMax_radps, kGyroBiasMax_radps);
}

/// A slower vehicle stands: what a speed sensor says at rest is less, and nobody drives so slowly. [m/s]
inline constexpr double kStill_mps = 0.01;
/// The same of turns: above a gyroscope's noise over a sample, below what anybody turns a vehicle with. [rad/s]
inline constexpr double kStillTurn_radps = radians(1.0);
/// So long must the vehicle have stood: springs have come to rest by then. [s]
inline constexpr double kSettles_s = 1.0;
/// Within so long the bias moves to what the gyroscope says of one that stands: a mean over hundreds of samples, and
/// soon enough for a halt at a crossing. [s]
inline constexpr double kStandingBias_s = 2.0;

/// For how long the vehicle has stood. No heap, no throw, constant time.
class Standing {
 public:
    [[nodiscard]] static bool is_still(double speed_mps) { return absolute(speed_mps) < kStill_mps; }
    /// Of a rate less its bias: more is a vehicle that is being moved.
    [[nodiscard]] static bool is_still_turn(double rate_radps) { return absolute(rate_radps) < kStillTurn_radps; }
    /// Of what the gyroscope says, the part by which its bias moves within dt_s.
    [[nodiscard]] static double bias_share(double dt_s) { return std::min(dt_s / kStandingBias_s, 1.0); }

    void add(bool still, double dt_s) { still_s_ = still ? still_s_ + dt_s : 0.0; }
    [[nodiscard]] bool has_begun() const { return still_s_ > 0.0; }
    /// For so long that the last wobble is over.
    [[nodiscard]] bool is_settled() const { return still_s_ > kSettles_s; }

 private:
    double still_s_ = 0.0;
};

}  // namespace crspf
