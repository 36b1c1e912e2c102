// What a configuration says of the robot, carried over to the simulated one.
#pragma once

#include "config/config.hpp"
#include "tools/sim/simulation.hpp"

namespace crspf::sim {

/// The sources that the simulated robot has: those in use, of which a configuration holds one each.
struct Carried {
    const SourceConfig* lidar;
    const SourceConfig* base;  ///< of kCan
};

/// Those of `config`, which must outlive them. Throws InputError where one is missing.
[[nodiscard]] Carried carried(const Config& config);

/// The lidar's mounting and rates, and of the vehicle the sizes that its odometry reckons with. `params.lidar` is a
/// model of the lidar's kind. Throws InputError for what cannot be simulated.
void carry(const Config& config, SimulationParams& params);

}  // namespace crspf::sim
