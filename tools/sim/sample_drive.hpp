// A simulated drive as samples in memory, as the core takes them: without a file, and without what a format rounds.
// For planar lidars.
#pragma once

#include <cstddef>
#include <functional>
#include <vector>

#include "core/base/lidar_params.hpp"
#include "core/base/pose.hpp"
#include "core/base/samples.hpp"
#include "core/base/time.hpp"
#include "tools/sim/scene.hpp"
#include "tools/sim/simulation.hpp"

namespace crspf::sim {

struct SampleDrive {
    /// A scan and the odometry that came since the scan before.
    struct Step {
        std::vector<MotionSample> motions;
        Scan scan;
    };
    std::vector<Step> steps;
    std::vector<Pose2> truth;  ///< P_map_base at each step's first beam; the map frame is base_link at the start
    Pose2 P_world_map;
    LidarParams lidar;  ///< what a configuration tells of it
    Duration length;
    double driven_m = 0.0;
    std::size_t given_up = 0;  ///< places that the robot did not get to
};

/// What a configuration tells of a simulated lidar.
[[nodiscard]] LidarParams told_lidar(const SimulationParams& params);

/// Throws what simulate() throws.
[[nodiscard]] SampleDrive record_drive(const Scene& scene, const SimulationParams& params);

/// For a drive too long to be held: `take` is told each step as it comes. @return the drive without its steps
SampleDrive stream_drive(const Scene& scene, const SimulationParams& params,
                         const std::function<void(SampleDrive::Step&)>& take);

}  // namespace crspf::sim
