// Every compile-time bound of the system, in one place. A deployment that needs other sizes edits this file only.
// Raising a bound costs memory as stated beside it; `crspf config --capacities` prints the resulting totals.
#pragma once

#include <cstddef>
#include <cstdint>

namespace crspf::capacity {

/// Beams in one scan. A Scan takes 5 bytes a beam, its working copies in the filter about 60.
inline constexpr std::size_t kBeams = 2048;

/// log2 of a map tile's side in cells: 64 x 64 cells a tile.
inline constexpr int kTileShift = 6;
/// Tiles of the map. A tile costs 12 KiB when it is used (4 KiB occupancy, 8 KiB match field) and nothing before.
inline constexpr std::size_t kTiles = 8192;
/// With more tiles than this those farthest from the robot go to the disk; the rest is for new land.
inline constexpr std::size_t kTilesKept = 7168;
/// Side of the directory in tiles: the map's largest extent. 1024 tiles of 64 cells of 0.025 m are 1638 m.
inline constexpr int kDirectoryTiles = 1024;

/// Odometry poses kept for interpolation at a scan's stamp: 10 s at 200 Hz.
inline constexpr std::size_t kMotionHistory = 2048;

/// Tilts of the vehicle kept for levelling a revolution of the lidar: 2.5 s at 400 Hz.
inline constexpr std::size_t kAttitudes = 1024;

/// Cells that one map update may change. A change that does not fit waits for the next scan and is counted.
inline constexpr std::size_t kCellChanges = 65536;

/// Hard upper bound of match evaluations per scan, whatever the configuration says.
inline constexpr std::uint32_t kEvaluationsPerScan = 20000;

/// Lasers of a lidar of many: the HDL-64E's.
inline constexpr std::size_t kCloudLasers = 64;
/// Sectors that the turn is cut into when obstacles are sought. One takes 512 bytes.
inline constexpr std::size_t kSectors = 1024;

/// Columns and points of one revolution of a Velodyne sensor. A column takes 17 bytes, a point 14: 3.6 MiB together,
/// enough for an HDL-64E S3 at 10 Hz (222k points) and an HDL-32E at 5 Hz (4340 columns).
inline constexpr std::size_t kCloudColumns = 8192;
inline constexpr std::size_t kCloudPoints = 262144;

}  // namespace crspf::capacity
