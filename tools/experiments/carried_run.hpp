// A drive played to the core as the service plays it to its modules: what each scan gave, beside the truth.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "core/base/pose.hpp"
#include "core/slam/localizer.hpp"
#include "core/slam/slam_params.hpp"
#include "platform/files/grid_map.hpp"
#include "tools/sim/sample_drive.hpp"

namespace crspf::experiments {

/// A scan of the run.
struct Matched {
    double time_s = 0.0;
    ScanResult result;
    double off_m = 0.0;  ///< from the true pose
    double off_deg = 0.0;
    double turn_radps = 0.0;  ///< of the robot, by its odometer
    bool carried = false;     ///< its odometry has been told wrongly, and nobody has told it better
};

/// Looking for a lost robot in the whole map.
struct SearchTally {
    std::size_t searches = 0;
    std::size_t found = 0;
    double first_found_s = 0.0;  ///< when; 0: never
};

struct CarriedRun {
    std::vector<Matched> scans;
    SearchTally search;
    GridMap map;  ///< as it was at the end
};

/// The robot is lifted and put down elsewhere: its odometry is told nothing of it. Here the robot stays, and the
/// odometry is told a way that has not been, which is the same to whoever knows the odometry alone.
struct Carry {
    std::size_t scan = 0;
    Pose2 P_base_told;
    std::size_t placed_at = 0;  ///< scan at which somebody tells where the robot is; 0: nobody
};

struct RunOptions {
    SlamParams params;
    std::vector<Carry> carries = {};
    const GridMap* map = nullptr;  ///< localise on it, and leave it as it is
    bool search = false;           ///< for a lost robot, as the service does
    std::size_t scans_max = 0;     ///< 0: the whole drive
};

[[nodiscard]] CarriedRun run_drive(const sim::SampleDrive& drive, const RunOptions& options);

}  // namespace crspf::experiments
