// What is an obstacle to the vehicle, in a cloud of many lasers.
#pragma once

#include <cstdint>

#include "core/base/trig.hpp"

namespace crspf {

/// Defaults: paper 4.1, and a car with its lidar on the roof.
struct ObstacleParams {
    std::uint32_t beams = 720;         ///< sectors of the full turn, 1 to capacity::kSectors
    double height_step_m = 0.10;       ///< [m] lower steps are driven over
    double slope_rad = radians(15.0);  ///< [rad] gentler slopes are driven up
    double range_max_m = 20.0;         ///< [m] farther obstacles are not told
    double vehicle_height_m = 2.0;     ///< [m] what hangs higher above the ground is driven under
    double lidar_height_m = 1.8;       ///< [m] above the ground below base_link
    double lidar_roll_rad = 0.0;       ///< [rad] of the mounting, about x, left side up positive
    double lidar_pitch_rad = 0.0;      ///< [rad] of the mounting, about y, looking down positive
    /// The vehicle's own body in base_link, which is not seen: from `body_x_min_m` to `body_x_max_m`, and as far to
    /// both sides. [m] Nothing where the two are equal.
    double body_x_min_m = 0.0;
    double body_x_max_m = 0.0;
    double body_half_width_m = 0.0;
};

}  // namespace crspf
