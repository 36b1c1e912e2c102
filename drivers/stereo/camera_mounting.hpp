// The camera's axes on the vehicle.
#pragma once

#include "core/base/trig.hpp"
#include "drivers/stereo/rigid_motion.hpp"
#include "drivers/stereo/stereo_params.hpp"

namespace crspf {

/// P_base_camera: from the left camera's optical axes (x right, y down, z forward) to base_link's (REP-103).
[[nodiscard]] inline RigidMotion camera_on_base(const CameraMounting& m) {
    const SinCos r = sin_cos(m.roll_rad);
    const SinCos p = sin_cos(m.pitch_rad);
    const SinCos y = sin_cos(m.yaw_rad);
    Eigen::Matrix3d Rx;
    Eigen::Matrix3d Ry;
    Eigen::Matrix3d Rz;
    Eigen::Matrix3d body_of_optical;
    Rx << 1.0, 0.0, 0.0, 0.0, r.cos, -r.sin, 0.0, r.sin, r.cos;
    Ry << p.cos, 0.0, p.sin, 0.0, 1.0, 0.0, -p.sin, 0.0, p.cos;
    Rz << y.cos, -y.sin, 0.0, y.sin, y.cos, 0.0, 0.0, 0.0, 1.0;
    body_of_optical << 0.0, 0.0, 1.0, -1.0, 0.0, 0.0, 0.0, -1.0, 0.0;
    return {Rz * Ry * Rx * body_of_optical, {m.x_m, m.y_m, m.z_m}};
}

}  // namespace crspf
