// Trajectories of cameras on disk, as KITTI's odometry benchmark writes them: the upper three rows of P_first_camera,
// row by row, a line a pose.
#pragma once

#include <array>
#include <filesystem>
#include <vector>

namespace crspf {

/// Optical axes: x right, y down, z forward. The fourth of each four is the position. [m]
using KittiPose = std::array<double, 12>;

/// Whether the first line with anything in it holds twelve numbers. Throws InputError for a file that cannot be read.
[[nodiscard]] bool looks_like_kitti_poses(const std::filesystem::path& file);

/// Throws InputError with file and line for anything that is not twelve finite numbers, or no rotation.
[[nodiscard]] std::vector<KittiPose> read_kitti_poses(const std::filesystem::path& file);

/// With 9 decimals. The file appears whole or not at all.
void write_kitti_poses(const std::vector<KittiPose>& poses, const std::filesystem::path& file);

}  // namespace crspf
