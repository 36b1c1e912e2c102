// The critical rays of scans, counted against the corners of a simulated world.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "config/capacities.hpp"
#include "core/base/lidar_params.hpp"
#include "core/slam/critical_rays.hpp"
#include "core/slam/scan_points.hpp"
#include "tools/experiments/corners.hpp"
#include "tools/sim/world.hpp"

namespace crspf::experiments {

/// A hit so near to a corner is at it.
inline constexpr double kAtCorner_m = 0.10;

/// Finds critical rays as the filter does.
class RayFinder {
 public:
    explicit RayFinder(const LidarParams& lidar) : rays_(CriticalRaysParams{}, lidar.range_noise_m) {}

    std::uint32_t find(const ScanPoints& points) { return rays_.select(points, critical_); }
    [[nodiscard]] bool critical(std::uint32_t i) const { return critical_[i]; }

 private:
    CriticalRays rays_;
    std::array<bool, capacity::kBeams> critical_{};
};

/// Hits by how the beam meets the wall: 0 to 30 degrees off its normal, to 60, to 90.
constexpr std::size_t kIncidences = 3;

struct RayCount {
    std::size_t scans = 0;
    std::size_t hits = 0;
    std::size_t critical = 0;
    std::size_t hits_at_corner = 0;
    std::size_t critical_at_corner = 0;
    std::size_t corners_in_view = 0;               ///< runs of neighbouring hits at a corner
    std::size_t corners_found = 0;                 ///< of those, with a critical ray in it
    std::array<std::size_t, kIncidences> plain{};  ///< hits away from corners
    std::array<std::size_t, kIncidences> wrong{};  ///< critical ones of them

    [[nodiscard]] static double share(std::size_t part, std::size_t whole) {
        return whole == 0 ? 0.0 : static_cast<double>(part) / static_cast<double>(whole);
    }
    [[nodiscard]] double critical_share() const { return share(critical_at_corner, critical); }
    [[nodiscard]] double all_share() const { return share(hits_at_corner, hits); }
    [[nodiscard]] double found_share() const { return share(corners_found, corners_in_view); }
    [[nodiscard]] double critical_per_scan() const { return share(critical, scans); }
    [[nodiscard]] double hits_per_scan() const { return share(hits, scans); }
};

/// Looks at each scan of a drive. What it is given must outlive it.
class RayTally {
 public:
    RayTally(const sim::World& world, const Corners& corners) : world_(world), corners_(corners) {}

    void add(const ScanPoints& points, const RayFinder& finder, const Pose2& P_world_base);
    [[nodiscard]] const RayCount& count() const { return count_; }

 private:
    const sim::World& world_;
    const Corners& corners_;
    RayCount count_;
};

}  // namespace crspf::experiments
