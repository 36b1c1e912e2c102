// The lidars that can be simulated, and what one of their beams reads.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "core/base/pose.hpp"
#include "tools/sim/random.hpp"
#include "tools/sim/world.hpp"

namespace crspf::sim {

/// Data sheet values. The sweep of a planar lidar is counter-clockwise; 0 is forward.
struct LidarModel {
    std::string name;
    std::uint32_t beams = 0;
    double angle_min_rad = 0.0;  ///< [rad] of beam 0
    double increment_rad = 0.0;
    double revolution_s = 0.0;    ///< [s] of the mirror
    double scan_rate_hz = 0.0;    ///< [Hz] at which scans are delivered
    double range_min_m = 0.0;     ///< [m] nearer reads 0
    double range_max_m = 0.0;     ///< [m]
    double no_return_m = 0.0;     ///< [m] what a beam without echo reads
    double noise_m = 0.0;         ///< [m] standard deviation ...
    double noise_fraction = 0.0;  ///< ... or this fraction of the range, whichever is more
    double dropout = 0.0;         ///< probability that a beam reads 0
    bool spatial = false;         ///< many rings: velodyne_sweep.hpp, and not for a log of planar scans

    [[nodiscard]] double time_per_beam_s() const;
};

/// `urg` (Hokuyo URG-04LX-UG01), `lms` (SICK LMS200, 1 degree), `scan270` (a 0.25 degree scanner of the Hokuyo
/// UST-10LX class) or `velodyne` (VLP-16; its beams are those of a planar scan out of a revolution). Throws InputError
/// for another name.
[[nodiscard]] LidarModel lidar_model(const std::string& name);

class Lidar {
 public:
    Lidar(LidarModel model, std::uint64_t seed);

    /// What beam `beam` reads in `world` among what moves, from where the lidar is at that moment. [mm]
    [[nodiscard]] int read_mm(const World& world, const Movers& movers, const Pose2& P_world_lidar, std::uint32_t beam);

    [[nodiscard]] const LidarModel& model() const { return model_; }

 private:
    LidarModel model_;
    Random random_;
};

}  // namespace crspf::sim
