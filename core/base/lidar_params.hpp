// How a planar lidar is mounted and which of its readings are believed.
#pragma once

#include "core/base/pose.hpp"
#include "core/base/samples.hpp"

namespace crspf {

struct LidarParams {
    Pose2 P_base_lidar;            ///< mounting: lidar frame in base_link
    bool mount_inverted = false;   ///< hangs upside down: its angles run clockwise seen from above
    double range_min_m = 0.05;     ///< [m] nearer readings are invalid
    double range_max_m = 40.0;     ///< [m] readings at or beyond are "no return"
    double range_noise_m = 0.01;   ///< [m] standard deviation of a reading
    double stamp_offset_s = 0.0;   ///< [s] added to the stamps of scans: negative where they are stamped late
    double time_per_beam_s = 0.0;  ///< [s] used where the source does not tell; 0: no de-skew
};

/// What a raw range means under `params`. NaN, zero, negative and too near are invalid; at or beyond range_max_m, and
/// +infinity, there was no return (REP-117).
[[nodiscard]] constexpr Beam classify(float range_m, const LidarParams& params) {
    if (!(static_cast<double>(range_m) >= params.range_min_m)) {
        return Beam::kInvalid;
    }
    return static_cast<double>(range_m) < params.range_max_m ? Beam::kHit : Beam::kNoReturn;
}

}  // namespace crspf
