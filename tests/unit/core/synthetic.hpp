// Worlds of straight walls, scans of them with known answers, and the core's large objects.
#pragma once

#include <cmath>
#include <cstdint>
#include <limits>
#include <memory>
#include <utility>
#include <vector>

#include "core/base/pose.hpp"
#include "core/base/rng.hpp"
#include "core/base/samples.hpp"
#include "core/slam/match_field.hpp"
#include "core/slam/occupancy.hpp"

namespace crspf::test {

/// One of the core's large objects on the heap. Not make_unique: without arguments that zeroes the memory once more.
template <typename T, typename... Args>
std::unique_ptr<T> make_large(Args&&... args) {
    if constexpr (sizeof...(Args) == 0) {
        return std::make_unique_for_overwrite<T>();
    } else {
        return std::make_unique<T>(std::forward<Args>(args)...);
    }
}

inline double uniform(Rng& rng, double low, double high) {
    return low + (high - low) * 0.5 * (rng.symmetric() + 1.0);
}
/// A whole number in [low, high].
inline std::int32_t whole(Rng& rng, std::int32_t low, std::int32_t high) {
    return low + static_cast<std::int32_t>(rng.next() % static_cast<std::uint32_t>(high - low + 1));
}

/// Shortest distance between two headings. [rad]
inline double turn_between(double a, double b) {
    return std::abs(wrap_angle(a - b));
}

struct Wall {
    double ax;
    double ay;
    double bx;
    double by;
};
using Walls = std::vector<Wall>;

inline void add_box(Walls& walls, double x0, double y0, double x1, double y1) {
    walls.push_back({x0, y0, x1, y0});
    walls.push_back({x1, y0, x1, y1});
    walls.push_back({x1, y1, x0, y1});
    walls.push_back({x0, y1, x0, y0});
}
/// A square room around the origin.
inline Walls square_room(double half_m) {
    Walls walls;
    add_box(walls, -half_m, -half_m, half_m, half_m);
    return walls;
}

/// Distance from the sensor to the first wall along its beam; infinity where there is none. [m]
inline double distance_to(const Walls& walls, const Pose2& P_world_lidar, double angle_rad) {
    const SinCos d = sin_cos(P_world_lidar.theta_rad + angle_rad);
    double nearest = std::numeric_limits<double>::infinity();
    for (const Wall& w : walls) {
        const double wx = w.bx - w.ax;
        const double wy = w.by - w.ay;
        const double across = d.cos * wy - d.sin * wx;
        if (std::abs(across) < 1e-12) {
            continue;
        }
        const double ox = w.ax - P_world_lidar.x_m;
        const double oy = w.ay - P_world_lidar.y_m;
        const double range = (ox * wy - oy * wx) / across;
        const double along = (ox * d.sin - oy * d.cos) / across;
        if (range > 0.0 && along >= 0.0 && along <= 1.0 && range < nearest) {
            nearest = range;
        }
    }
    return nearest;
}

/// The beams of a scan, without readings. Beams past `count` stay invalid.
inline Scan beams_of(std::uint32_t count, double angle_min_rad, double angle_max_rad) {
    Scan scan;
    scan.count = count;
    scan.angle_min_rad = angle_min_rad;
    scan.angle_increment_rad = count > 1 ? (angle_max_rad - angle_min_rad) / (count - 1) : 0.01;
    return scan;
}

/// Takes the scan. @param lidar_at(seconds since beam 0) is P_world_lidar; no wall: no return
template <typename LidarAt>
void measure(Scan& scan, const Walls& walls, LidarAt&& lidar_at) {
    for (std::uint32_t i = 0; i < scan.count; ++i) {
        const double angle_rad = scan.angle_min_rad + i * scan.angle_increment_rad;
        const double range_m = distance_to(walls, lidar_at(i * scan.time_per_beam_s), angle_rad);
        scan.beam[i] = std::isfinite(range_m) ? Beam::kHit : Beam::kNoReturn;
        scan.range_m[i] = std::isfinite(range_m) ? static_cast<float>(range_m) : 0.0F;
    }
}
inline void measure_at(Scan& scan, const Walls& walls, const Pose2& P_world_lidar) {
    measure(scan, walls, [&](double) { return P_world_lidar; });
}

/// A map and the field that follows it, written cell by cell.
class MapAndField {
 public:
    void set(Cell cell, Evidence after) {
        auto* tile = map_.touch(cell);
        if (tile == nullptr) {
            return;
        }
        Evidence& value = tile->cells[TileGeometry::offset(cell)];
        const CellChange change{.cell = cell, .before = value, .after = after};
        value = after;
        field_.follow({&change, 1});
    }
    /// A wall of occupied cells.
    void draw(const Wall& wall, double resolution_m) {
        const double length_m = std::hypot(wall.bx - wall.ax, wall.by - wall.ay);
        const int steps = static_cast<int>(length_m / resolution_m * 4.0) + 1;
        for (int k = 0; k <= steps; ++k) {
            const double u = static_cast<double>(k) / steps;
            set({.x = floor_to_cell((wall.ax + u * (wall.bx - wall.ax)) / resolution_m),
                 .y = floor_to_cell((wall.ay + u * (wall.by - wall.ay)) / resolution_m)},
                kOccupiedCell);
        }
    }

    [[nodiscard]] const OccupancyMap& map() const { return map_; }
    [[nodiscard]] const MatchField& field() const { return field_; }

 private:
    OccupancyMap map_;
    MatchField field_;
};

/// FNV-1a over the tiles of a map: equal for equal maps.
inline std::uint64_t digest(const OccupancyMap& map) {
    std::uint64_t hash = 1469598103934665603ULL;
    const auto mix = [&hash](std::uint64_t v) { hash = (hash ^ v) * 1099511628211ULL; };
    map.for_each_tile([&](Cell corner, const OccupancyTile& tile) {
        mix(static_cast<std::uint32_t>(corner.x));
        mix(static_cast<std::uint32_t>(corner.y));
        for (const Evidence e : tile.cells) {
            mix(e);
        }
    });
    return hash;
}

}  // namespace crspf::test
