// Every setting of the SLAM core, by module. Defaults serve a robot with wheel odometry and a 180 to 270 degree indoor
// lidar; they come from the paper where it gives a value and otherwise from the sensor and the physics
// (core/DESIGN.md).
#pragma once

#include <cstdint>

#include "core/base/lidar_params.hpp"
#include "core/base/trig.hpp"
#include "core/odometry/odometry_params.hpp"
#include "core/slam/obstacle_params.hpp"

namespace crspf {

/// Paper 4.2.
struct CriticalRaysParams {
    bool enabled = true;
    int window_min = 4;                     ///< [points] d_min of (4), (5)
    int window_max = 8;                     ///< [points] d_max of (4), (5)
    double angle_max_rad = radians(125.0);  ///< [rad] sharper is critical
    double weight = 5.0;                    ///< a_i of (10) for a critical ray; other rays weigh 1
};

/// Paper 4.3.
struct ParticleFilterParams {
    bool feedback = true;                       ///< (9): range and number follow M(t-1); off: always the largest
    double match_min = 500.0;                   ///< M_min of (9), on the scale of (10): 0 to 2975
    double match_max = 1200.0;                  ///< M_max of (9)
    std::uint32_t particles_min = 30;           ///< loopnum at M_max
    std::uint32_t particles_max = 600;          ///< loopnum at M_min
    double range_min_m = 0.06;                  ///< [m] X^M, Y^M at M_max
    double range_max_m = 0.30;                  ///< [m] X^M, Y^M at M_min
    double angle_min_rad = radians(2.0);        ///< [rad] A^M at M_max
    double angle_max_rad = radians(12.0);       ///< [rad] A^M at M_min
    double range_stddevs = 3.0;                 ///< the range is at least so many standard deviations of the odometry
    double points_min_fraction = 60.0 / 720.0;  ///< N_s over the scan's beams: with fewer hits the odometry stands
    std::uint32_t evaluations_max = 1000;       ///< hard bound per scan
    double pull_weight = 0.006;                 ///< score lost per squared standard deviation away from P~
    double pull_saturation = 50.0;              ///< squared standard deviations at which half the pull is let go
    bool refinement = true;                     ///< the optimum is sought below the cell size
    bool degeneracy = true;                     ///< a direction that the scan does not see keeps the odometry's word
    double degenerate_below = 0.005;            ///< information along it, over that across, which counts as not seen
    std::uint64_t seed = 1;
};

/// Paper 4.4: (12), (13). Scale as in (10).
struct AnalyserParams {
    double result_on = 700.0;   ///< M_u
    double result_off = 500.0;  ///< M_l
    double draw_on = 150.0;     ///< M_u^d
    double draw_off = 75.0;     ///< M_l^d
};

/// Paper 5.
struct MapParams {
    double resolution_m = 0.02;      ///< [m] side of a cell
    int hit = 80;                    ///< [1/255] added to a cell by a hit
    int pass = 5;                    ///< [1/255] taken from a cell by a ray that passes, or that ends just before it
    int behind_cells = 2;            ///< [cells] behind a hit from which evidence is taken: keeps walls thin
    double no_return_clear_m = 0.0;  ///< [m] how far a beam without echo clears; 0: not at all
    bool remove_errors = true;
    double stable_range_m = 3.0;  ///< [m] key-frame points nearer than this bound the passable area
    double erosion_m = 0.08;      ///< [m] the passable area is shrunk by this before it is cleared
};

struct SlamParams {
    LidarParams lidar;
    ObstacleParams obstacles;
    OdometryParams odometry;
    CriticalRaysParams critical_rays;
    ParticleFilterParams particle_filter;
    AnalyserParams analyser;
    MapParams map;
    bool deskew = true;          ///< place each beam by the odometry at its own time
    bool localize_only = false;  ///< the map is given and stays as it is
};

}  // namespace crspf
