// Map update (paper Section 5): draws a scan, removes errors, or leaves the map as it is.
//
// The map belongs to this module alone. What it changes it says in a ChangeList, and the match field of the particle
// filter follows from that: the two never share a cell, so the update may run in a thread of its own.
#pragma once

#include <array>
#include <cstdint>

#include "config/capacities.hpp"
#include "core/base/pose.hpp"
#include "core/slam/occupancy.hpp"
#include "core/slam/scan_points.hpp"
#include "core/slam/slam_params.hpp"

namespace crspf {

/// Never reset.
struct MapUpdateCounters {
    std::uint64_t drawn = 0;         ///< scans drawn
    std::uint64_t cleaned = 0;       ///< key frames whose passable area was cleared
    std::uint64_t cells_erased = 0;  ///< cells with evidence that error removal set free
};

/// No heap, no throw; linear in the cells under the rays, whatever the map's size. One owner.
class MapUpdate {
 public:
    MapUpdate(const MapParams& params, double range_noise_m) : params_(params), range_noise_m_(range_noise_m) {}

    /// Draws the scan at `P_map_base`: free along each ray, occupied at its hit. With `key_frame` it also clears the
    /// passable area: the near, stable points bound it, shrunk by the erosion. Appends what changed to `changes`.
    void draw(const ScanPoints& points, const Pose2& P_map_base, bool key_frame, ChangeList& changes);

    /// Sets one cell.
    void set(Cell cell, Evidence evidence, ChangeList& changes);
    /// Fills in what the map has not seen of a tile. Only where the map is not full. Constant time, as is forget().
    void restore(Cell corner, const TileCells& cells, ChangeList& changes);
    /// Of a tile that the map has: it has it no longer.
    void forget(Cell corner, ChangeList& changes);

    [[nodiscard]] const OccupancyMap& map() const { return map_; }
    [[nodiscard]] const MapUpdateCounters& counters() const { return counters_; }

 private:
    /// A ray in cells. Its first `cleared` of 1 is set free outright.
    struct Ray {
        double from_x;
        double from_y;
        double to_x;
        double to_y;
        double cleared;
    };

    /// The same by the coordinate along which it moves fastest.
    struct Line {
        double from_major;
        double from_minor;
        double major;
        double minor;
    };

    void mark_passable(const ScanPoints& points);
    void trace_free(const Ray& ray, ChangeList& changes);
    template <bool Steep>
    void trace_line(const Line& line, double cleared_share, ChangeList& changes);
    void lower(OccupancyTile& tile, Cell cell, Evidence before, bool outright, ChangeList& changes);
    /// Raises the hit's cell and lowers those behind it. `per_cell`: the share of the ray that is a cell long.
    void mark_hit(const Ray& ray, Cell hit, double per_cell, ChangeList& changes);
    void write(OccupancyTile& tile, Cell cell, Evidence after, ChangeList& changes);

    MapParams params_;
    double range_noise_m_;
    OccupancyMap map_;
    MapUpdateCounters counters_;
    /// Range up to which each hit's ray is cleared outright. [m]
    std::array<float, capacity::kBeams> passable_m_{};
};

}  // namespace crspf
