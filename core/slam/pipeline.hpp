// CRSPF-SLAM as one object: samples in, poses and a map out. The paper's modules, called one after the other; the
// service runs the same ones in threads of their own. All of its state is inside and has its size at compile time: put
// it in static storage or allocate it once.
//
// Frames as in localizer.hpp. Real-time guarantee of every on_...(): no heap, no lock, no throw, no I/O, no clock; time
// bounded by the beams, the configured evaluations and the cells under the rays.
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <span>

#include "core/base/cloud.hpp"
#include "core/base/samples.hpp"
#include "core/base/spsc_ring.hpp"
#include "core/odometry/odometry.hpp"
#include "core/slam/localizer.hpp"
#include "core/slam/roaming_map.hpp"
#include "core/slam/slam_params.hpp"

namespace crspf {

/// How a running service was timed when it matched a scan, for doing the same again. The default is what one thread
/// does.
struct ScanTiming {
    std::uint64_t changes = std::numeric_limits<std::uint64_t>::max();  ///< updates whose changes were known by then
    bool update = true;                                                 ///< the map's update had room for it
    /// MapTask::tidy and MapTask::tiles. None: as it comes.
    struct Tiles {
        bool tidy = false;
        std::uint32_t tiles = 0;
    };
    std::optional<Tiles> tiles = {};
};

class Pipeline {
 public:
    explicit Pipeline(const SlamParams& params, Kernel kernel = Kernel::kFastest)
        : localizer_(params, kernel), map_(params, tile_rings_) {}

    void on_wheel(const DifferentialSample& sample) { localizer_.on_wheel(sample); }
    void on_wheel(const AckermannSample& sample) { localizer_.on_wheel(sample); }
    void on_imu(const ImuSample& sample) { localizer_.on_imu(sample); }
    void on_motion(const MotionSample& sample) { localizer_.on_motion(sample); }
    /// Odometry up to the scan's last beam should have come before; where it has not, the last speed is extrapolated.
    ScanResult on_scan(const Scan& scan, const ScanTiming& timing = {});
    /// The scan of a revolution's obstacles (paper 4.1). None where it is not complete.
    std::optional<ScanResult> on_cloud(const Cloud& cloud, const ScanTiming& timing = {});

    /// Places the robot, for example on a loaded map; see Localizer.
    void set_pose(const Pose2& P_map_base) { localizer_.set_pose(P_map_base); }
    void forget_pose() { localizer_.forget_pose(); }
    /// A part of a map that is loaded, before the first scan. Only where the map is not full.
    void load(const TileRecord& tile);

    /// For a keeper of far tiles, who has to take what is sent away from now on. Without one the map ends where its
    /// pool is used up.
    [[nodiscard]] TileRings& add_tile_keeper() {
        has_keeper_ = true;
        return tile_rings_;
    }

    [[nodiscard]] const OccupancyMap& map() const { return map_.map(); }
    /// Of the last scan: its hits, and which of them lie on critical rays.
    [[nodiscard]] const ScanPoints& points() const { return localizer_.points(); }
    [[nodiscard]] std::span<const bool> critical() const { return localizer_.critical(); }
    [[nodiscard]] const Odometry& odometry() const { return localizer_.odometry(); }
    [[nodiscard]] const LocalizerCounters& counters() const { return localizer_.counters(); }
    [[nodiscard]] const MapUpdateCounters& map_counters() const { return map_.counters(); }
    /// Changes of the map that did not fit a scan's change list. Never reset.
    [[nodiscard]] std::uint64_t changes_refused() const { return changes_refused_; }

 private:
    void follow(const ScanTiming& timing);
    void update_map(const ScanResult& result, const ScanTiming& timing);

    Localizer localizer_;
    TileRings tile_rings_;
    RoamingMap map_;
    bool has_keeper_ = false;
    std::uint32_t tiles_ = 0;  ///< MapTask::tiles of the last update
    /// Of the map updates that the filter's image does not know yet: as many as the service has under way.
    static constexpr std::size_t kUpdates = 8;
    SpscRing<ChangeList, kUpdates> changes_;
    std::uint64_t followed_ = 0;
    std::uint64_t changes_refused_ = 0;
};

}  // namespace crspf
