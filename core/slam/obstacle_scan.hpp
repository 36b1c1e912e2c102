// LRF update (paper 4.1, Fig. 6): a revolution of many lasers -> the planar scan of its obstacles, which the rest of
// the system takes for that of a lidar with one.
#pragma once

#include <array>
#include <cstdint>

#include "config/capacities.hpp"
#include "core/base/cloud.hpp"
#include "core/base/lidar_params.hpp"
#include "core/base/samples.hpp"
#include "core/base/trig.hpp"
#include "core/odometry/attitude.hpp"
#include "core/slam/obstacle_params.hpp"

namespace crspf {

/// Each sector of the turn is walked outward, from the ground below the vehicle to its lasers' points from the lowest
/// laser to the highest. Of what has passed, the point with the least z - r tan(slope) is remembered; one that lies
/// higher than that by the height step, and steeper, is an obstacle. (The paper compares with the predecessor only: on
/// a near wall the points of 64 lasers are less than a step apart.) The sector's range is the nearest obstacle's; but
/// that of a wall, or of the edge of one, is what stands in the sector's middle, where the beam is. A sector without an
/// obstacle is clear as far as its lasers have seen ground without a gap; where they saw none it is invalid.
///
/// Frame: the lidar's, upright, with its origin above the lidar's place in base_link when the vehicle is level. Each
/// beam has its own time, as in any scan, so that the projection of the scan takes the motion out of it; within a
/// sector nothing moves. 1.3 MiB. No heap, no throw; linear in the points. One owner.
class ObstacleScanner {
 public:
    ObstacleScanner(const ObstacleParams& params, const LidarParams& lidar);

    /// False, and `out` without beams, for a revolution that is not complete. Of two returns the last is taken, which
    /// sees through rain and glass.
    /// @param attitude of the vehicle, by which the points are levelled
    [[nodiscard]] bool scan(const Cloud& cloud, const AttitudeHistory& attitude, Scan& out);

 private:
    using PerLaser = std::array<float, capacity::kCloudLasers>;

    void level(const Vector3& up);
    void gather(const Cloud& cloud, std::uint32_t column);
    [[nodiscard]] bool is_body(float x_m, float y_m, float z_m) const;
    /// Where a walk ends.
    struct Walked {
        float obstacle_m = 0.0F;  ///< beyond range_max_m: none
        float ground_m = 0.0F;    ///< seen so far without a gap
    };
    /// A point of a laser.
    struct Point {
        float squared = 0.0F;  ///< [m^2] of the horizontal range; far away: there is none
        float z_m = 0.0F;      ///< above the ground below base_link
    };
    /// What a laser saw in a sector: together, since they are read and written together.
    struct Seen {
        Point nearest;
        Point middle;             ///< the one nearest to the sector's middle
        float off_middle = 0.0F;  ///< how near [sectors]
    };
    using Sector = std::array<Seen, capacity::kCloudLasers>;  // by rank
    [[nodiscard]] Walked walk(const Sector& sector, Point Seen::*which) const;
    void tell(std::uint32_t sector, Scan& out) const;

    ObstacleParams params_;
    LidarParams lidar_;
    double sector_rad_;
    SinCos yaw_;
    float ground_slope_;                ///< tan
    float body_m2_;                     ///< farther from the lidar, squared, there is no body
    std::array<double, 9> mounting_{};  ///< turns the sensor's axes into base_link's

    // Of the revolution in hand.
    std::uint32_t lasers_ = 0;
    std::array<std::uint8_t, capacity::kCloudLasers> rank_{};  ///< of a laser, counted upward
    double cut_rad_ = 0.0;

    // From the sensor's axes to the frame above, for the columns in hand.
    std::array<float, 9> rotation_{};
    std::array<float, 3> origin_m_{};

    // Of the column in hand, by laser.
    PerLaser z_m_{};      ///< above the ground below base_link
    PerLaser squared_{};  ///< [m^2] of the horizontal range
    PerLaser sector_{};   ///< with a fraction

    std::array<Sector, capacity::kSectors> seen_{};
    std::array<Walked, capacity::kSectors> by_nearest_{};
    std::array<Walked, capacity::kSectors> by_middle_{};
};

}  // namespace crspf
