// What a configuration says of the robot, carried over to the simulated one.
#pragma once

#include "config/config.hpp"
#include "tools/sim/simulation.hpp"

namespace crspf::sim {

/// The sources that the simulated robot has: those in use, of which a configuration holds one each.
struct Carried {
    const SourceConfig* lidar;
    const SourceConfig* base;  ///< of kCan; null: a stereo camera is its odometer
};

/// Those of `config`, which must outlive them. Throws InputError where one is missing.
[[nodiscard]] Carried carried(const Config& config);

/// The lidar's and the stereo camera's mounting and rates, and of the vehicle the sizes that its odometry reckons with.
/// `params.lidar` is a model of the lidar's kind. Throws InputError for what cannot be simulated.
void carry(const Config& config, SimulationParams& params);

/// The camera as [stereo] describes it; where that names no calibration, of the usual field of view. Throws InputError
/// for a file that is not of a rectified pair.
[[nodiscard]] StereoRigParams stereo_of(const StereoConfig& config);

}  // namespace crspf::sim
