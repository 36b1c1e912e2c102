// What stereo odometry must know of the camera on the vehicle.
#pragma once

#include <cstdint>

namespace crspf {

/// The left camera seen from base_link, looking along x where all angles are 0: turned about z, then about the new y,
/// then about the new x (REP-103).
struct CameraMounting {
    double x_m = 0.0;
    double y_m = 0.0;
    double z_m = 1.0;  ///< above the ground
    double roll_rad = 0.0;
    double pitch_rad = 0.0;  ///< looking down
    double yaw_rad = 0.0;    ///< to the left
};

struct StereoParams {
    CameraMounting mounting;
};

}  // namespace crspf
