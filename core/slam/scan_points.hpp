// A scan as points in base_link, each placed by the odometry at its own time (de-skew).
#pragma once

#include <array>
#include <cstdint>

#include "config/capacities.hpp"
#include "core/base/lidar_params.hpp"
#include "core/base/samples.hpp"
#include "core/odometry/odometry.hpp"

namespace crspf {

/// The hits and the clear beams of one scan, in beam order. Frame: base_link at the scan's stamp. [m]
struct ScanPoints {
    std::uint32_t count = 0;  ///< hits
    std::uint32_t beams = 0;  ///< beams of the scan: N_s^max of (11)
    std::array<float, capacity::kBeams> x_m{};
    std::array<float, capacity::kBeams> y_m{};
    std::array<float, capacity::kBeams> range_m{};
    std::array<std::uint16_t, capacity::kBeams> beam{};  ///< index in the scan, growing

    std::uint32_t clear_count = 0;                    ///< beams that met nothing
    std::array<float, capacity::kBeams> clear_x_m{};  ///< a point 1 m along the beam
    std::array<float, capacity::kBeams> clear_y_m{};
    std::array<float, capacity::kBeams> clear_m{};  ///< free so far; 0: without return, nobody knows how far
    std::array<std::uint16_t, capacity::kBeams> clear_beam{};

    double angle_increment_rad = 0.0;
    /// The lidar's place when beam 0 and when the last beam was measured: it moves linearly between.
    Pose2 P_base_first_lidar;
    Pose2 P_base_last_lidar;
};

/// Turns scans into points. Keeps the sines of the last scan's beams, which rarely change.
/// No heap, no throw; linear in the beams. One owner.
class ScanProjector {
 public:
    ScanProjector(const LidarParams& lidar, bool deskew) : lidar_(lidar), deskew_(deskew) {}

    /// A beam whose range is none by LidarParams is left out.
    /// @param odometry gives the motion while the scan was taken
    void project(const Scan& scan, const Odometry& odometry, ScanPoints& out);

 private:
    void update_directions(const Scan& scan, std::uint32_t beams);

    LidarParams lidar_;
    bool deskew_;
    double angle_min_rad_ = 0.0;
    double angle_increment_rad_ = 0.0;
    std::uint32_t directions_ = 0;
    std::array<double, capacity::kBeams> cos_{};
    std::array<double, capacity::kBeams> sin_{};
};

}  // namespace crspf
