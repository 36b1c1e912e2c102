// What a recorded run told of the vehicle's motion, and where the scans found its lidar.
#pragma once

#include <vector>

#include "core/base/pose.hpp"
#include "core/base/samples.hpp"
#include "core/base/time.hpp"

namespace crspf::calibrate {

/// Of the lidar, between two scans.
struct Piece {
    Stamp from;  ///< of the first beams
    Stamp to;
    Pose2 P_from_to;
};

/// Samples as the sensors told them, with none of the corrections of OdometryParams but an IMU's roll and pitch.
struct Drive {
    std::vector<DifferentialSample> wheels;
    std::vector<AckermannSample> car;
    std::vector<ImuSample> imu;
    std::vector<Piece> pieces;
};

}  // namespace crspf::calibrate
