// The map of a robot that goes farther than the pool of tiles reaches (beyond the paper). What is far from the robot is
// handed to a keeper outside the core, who writes it to a disk, and who brings it back before the robot sees it again.
// Neither waits for the other: two rings lie between them.
#pragma once

#include <cstdint>

#include "core/base/pose.hpp"
#include "core/base/spsc_ring.hpp"
#include "core/slam/map_update.hpp"
#include "core/slam/occupancy.hpp"
#include "core/slam/scan_points.hpp"
#include "core/slam/slam_params.hpp"

namespace crspf {

/// A tile on its way to or from the keeper; or, to the keeper, where the robot is.
struct TileRecord {
    enum class Kind : std::uint8_t { kTile, kRobot };
    Kind kind = Kind::kTile;
    Cell cell;                ///< the tile's lower-left corner, or the robot's cell
    std::int32_t within = 0;  ///< [cells] kRobot: tiles whose middle is nearer than this are to come back
    TileCells cells{};        ///< kTile
};

/// Of the tile's middle from a cell. [cells^2]
constexpr std::int64_t squared_distance(Cell corner, Cell from) {
    const std::int64_t x = corner.x + TileGeometry::kSide / 2 - from.x;
    const std::int64_t y = corner.y + TileGeometry::kSide / 2 - from.y;
    return x * x + y * y;
}

struct TileRings {
    SpscRing<TileRecord, 128> away;  ///< map -> keeper
    SpscRing<TileRecord, 128> back;  ///< keeper -> map
};

/// What is to be done for a scan that was matched. The filter decides it, so that a replay can do the same.
struct MapTask {
    Pose2 P_map_base;
    bool draw = false;        ///< else the map stays as it is, but for tiles that come and go
    bool key_frame = false;   ///< MapUpdate::draw()'s
    bool tidy = false;        ///< far tiles may go: there is room for them in the ring
    double sight_m = 0.0;     ///< sight_of() the scan
    std::uint32_t tiles = 0;  ///< from the keeper that are in the map after it, since the start, modulo 2^32
};

/// How far the scan saw. [m]
[[nodiscard]] double sight_of(const ScanPoints& points);
/// Whether `tidy` may be set, while `before` updates are under way that may do so too.
[[nodiscard]] bool room_to_tidy(const TileRings& rings, std::size_t before);
/// MapTask::tiles of an update after one with `tiles`.
[[nodiscard]] std::uint32_t next_tiles(const TileRings& rings, std::uint32_t tiles);

/// No heap, no throw; linear in the cells under the rays and in the pool's tiles. One owner.
class RoamingMap {
 public:
    RoamingMap(const SlamParams& params, TileRings& rings)
        : update_(params.map, params.lidar.range_noise_m),
          rings_(rings),
          cells_per_metre_(1.0 / params.map.resolution_m) {}

    /// One scan, drawn or not; tiles that the keeper has brought are taken in, and those farthest from the robot are
    /// sent away where the pool has few left. At most ChangeList::kTilesEachWay either way.
    void update(const MapTask& task, const ScanPoints& points, ChangeList& changes);
    /// A part of a map that is loaded.
    void load(const TileRecord& tile, ChangeList& changes) { update_.restore(tile.cell, tile.cells, changes); }

    [[nodiscard]] const OccupancyMap& map() const { return update_.map(); }
    [[nodiscard]] const MapUpdateCounters& counters() const { return update_.counters(); }

 private:
    void take_back(std::uint32_t tiles, ChangeList& changes);
    void send_away(Cell robot, std::int32_t sight, ChangeList& changes);

    MapUpdate update_;
    TileRings& rings_;
    double cells_per_metre_;
    double sight_m_ = 0.0;  ///< of all scans
    std::uint32_t taken_ = 0;
};

}  // namespace crspf
