// A Velodyne VLP-16 or HDL-32E on the robot, as the datagrams that it sends.
#pragma once

#include <memory>

#include "tools/sim/sweep.hpp"
#include "tools/sim/world3d.hpp"

namespace crspf::sim {

inline constexpr std::uint16_t kVelodyneDataPort = 2368;
inline constexpr std::uint16_t kVelodynePositionPort = 8308;

/// Each column is fired from where the robot is at that instant. The head turns as params.lidar tells and passes the
/// cut behind at the drive's start; the sensor's clock is its own, without GPS. `world` must outlive it.
[[nodiscard]] std::unique_ptr<Sweep> velodyne_sweep(const World3d& world, const SimulationParams& params);

}  // namespace crspf::sim
