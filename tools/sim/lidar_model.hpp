// The lidars that can be simulated, and what one of their beams reads.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "config/sources.hpp"
#include "core/base/pose.hpp"
#include "tools/sim/random.hpp"
#include "tools/sim/world.hpp"

namespace crspf::sim {

/// Data sheet values. The sweep of a planar lidar is counter-clockwise; 0 is forward.
struct LidarModel {
    std::string name;
    SourceDriver driver = SourceDriver::kScip;       ///< which understands it
    VelodyneModel velodyne = VelodyneModel::kVlp16;  ///< which of them, where it is one
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

    /// Many rings: velodyne_sweep.hpp, and not for a log of planar scans.
    [[nodiscard]] bool spatial() const { return driver == SourceDriver::kVelodyne; }
    [[nodiscard]] double time_per_beam_s() const;
};

/// `urg` (Hokuyo URG-04LX-UG01), `lms` (SICK LMS200, 1 degree), `lms1xx` (SICK LMS111), `lms5xx` (SICK LMS511),
/// `scan270` (a 0.25 degree scanner of the Hokuyo UST-10LX class) `velodyne` (VLP-16) or `hdl32e`, whose beams are
/// those of a planar scan out of a revolution. Throws InputError for another name.
[[nodiscard]] LidarModel lidar_model(const std::string& name);

/// A lidar that looks all round, up to 10 m, ten times a second, and reads all beams of a scan at once.
[[nodiscard]] LidarModel all_round_lidar(std::uint32_t beams);

/// Of one driver, those that see farther come later.
inline constexpr const char* kLidarNames[] = {"urg", "lms", "lms1xx", "lms5xx", "scan270", "velodyne", "hdl32e"};

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
