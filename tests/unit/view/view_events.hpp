// Events of a run, made up.
#pragma once

#include <cstdint>

#include "tools/view/run_events.hpp"

namespace crspf::view::test {

inline constexpr std::int64_t kStart_ns = 1'700'000'000'000'000'000;
inline constexpr std::int64_t kSecond_ns = 1'000'000'000;

inline ScanEvent scan_at(std::int64_t stamp_ns, double x_m = 0.0) {
    ScanEvent scan;
    scan.stamp_ns = stamp_ns;
    scan.P_map_base = {.x_m = x_m, .y_m = -2.0, .theta_rad = 0.5};
    scan.P_map_odom = {.x_m = 0.25, .y_m = 0.0, .theta_rad = -0.125};
    scan.covariance = {.xx = 1.0, .xy = 2.0, .yy = 3.0, .xt = 4.0, .yt = 5.0, .tt = 6.0};
    scan.M = 2000.0;
    scan.rays = 2;
    scan.points = {{.x_m = 1.5F, .y_m = -0.25F, .critical = false}, {.x_m = 3.0F, .y_m = 2.0F, .critical = true}};
    return scan;
}

/// A tile whose cells all show `percent`.
inline TileImage tile_at(std::int32_t column, std::int32_t row, std::uint8_t percent) {
    TileImage tile{.corner = {.x = column * TileGeometry::kSide, .y = row * TileGeometry::kSide}};
    tile.cells.fill(percent);
    return tile;
}

}  // namespace crspf::view::test
