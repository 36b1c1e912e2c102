// The speed of a vehicle that tells none: from the way between the poses that the filter found, and where an IMU feels
// it, from the acceleration in between.
#pragma once

#include <algorithm>

#include "core/base/real.hpp"
#include "core/base/time.hpp"

namespace crspf {

/// What accelerations sum up to drifts; what the scans say comes late, and scatters. The difference between the two
/// changes slowly, so that it is no matter how late it is known: it is the state of a Kalman filter of one dimension.
/// Without accelerations the difference is the speed itself, and changes as fast as vehicles do.
/// No heap, no throw, constant time; one owner.
class SpeedEstimate {
 public:
    /// The vehicle moved on for dt_s. @param forward_mps2 0 where nobody feels it
    void accelerate(double forward_mps2, double dt_s, bool felt) {
        felt_mps_ += forward_mps2 * dt_s;
        change_ = felt ? kChangeFelt : kChange;
    }

    /// [m/s] forward positive
    [[nodiscard]] double speed_mps() const { return felt_mps_ + rest_mps_; }
    /// What the accelerations alone have summed up to. [m/s]
    [[nodiscard]] double felt_mps() const { return felt_mps_; }
    /// Of the speed at an instant, which is the less sure the later. [m/s]
    [[nodiscard]] double stddev_mps(Stamp stamp) const { return square_root(variance_at(stamp)); }

    /// Two scans' poses are so far apart that in between the speed was on average `rest_mps` more than what was felt.
    void measure(double rest_mps, Stamp from, Stamp to) {
        const double between_s = (to - from).seconds();
        const Stamp middle = from + Duration{(to - from).ns / 2};
        const double before = variance_at(middle);
        const double noise = 2.0 * square(kPose_m / between_s);
        const double surprise_mps = rest_mps - rest_mps_;
        if (square(surprise_mps) > square(kGate) * (before + noise)) {
            return;  // the robot was placed, or a scan was matched wrongly; what stays is believed after a while
        }
        const double gain = before / (before + noise);
        rest_mps_ += gain * surprise_mps;
        variance_ = (1.0 - gain) * before;
        measured_ = middle;
        begun_ = true;
    }

 private:
    static constexpr double kMost = 25.0;        ///< [(m/s)^2] variance where nothing was heard for long
    static constexpr double kBegin = 1.0;        ///< [(m/s)^2] variance of a robot of which nothing is known
    static constexpr double kChange = 1.0;       ///< [(m/s)^2/s] vehicles speed up and brake by a m/s in a second
    static constexpr double kChangeFelt = 0.04;  ///< [(m/s)^2/s] a tilt that is 1 deg off is felt as 0.17 m/s^2
    static constexpr double kPose_m = 0.01;      ///< of a scan's pose: standard deviation
    static constexpr double kGate = 5.0;         ///< standard deviations

    [[nodiscard]] double variance_at(Stamp stamp) const {
        const double later_s = std::max((stamp - measured_).seconds(), 0.0);
        return begun_ ? std::min(variance_ + change_ * later_s, kMost) : kBegin;
    }

    double felt_mps_ = 0.0;
    double rest_mps_ = 0.0;
    double change_ = kChange;
    double variance_ = kBegin;  ///< of rest_mps_ ...
    Stamp measured_;            ///< ... at this instant
    bool begun_ = false;
};

}  // namespace crspf
