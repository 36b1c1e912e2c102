// Where an IMU of six axes points, from what driving does to its accelerations: along the way the change of the speed,
// across it speed times yaw rate.
#pragma once

#include <optional>
#include <vector>

#include "core/base/samples.hpp"
#include "tools/calibrate/estimate.hpp"

namespace crspf::calibrate {

/// Of OdometryParams::imu_yaw_rad. None without accelerations.
[[nodiscard]] std::optional<Estimate> imu_yaw(const std::vector<ImuSample>& imu);

/// Of the yaw rate while the speed is zero. None where it never stood for a second.
[[nodiscard]] std::optional<Estimate> standing_bias(const std::vector<ImuSample>& imu);

}  // namespace crspf::calibrate
