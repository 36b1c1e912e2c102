// Trajectories on disk: TUM format, `timestamp tx ty tz qx qy qz qw` a line.
#pragma once

#include <filesystem>
#include <vector>

#include "core/base/pose.hpp"

namespace crspf {

struct TimedPose {
    double stamp_s = 0.0;  ///< [s] as recorded; not necessarily increasing
    Pose2 P_map_base;
};

/// The pose in the plane: z, roll and pitch are dropped. Throws InputError with file and line on anything that is not a
/// TUM line, a `#` comment or an empty line.
[[nodiscard]] std::vector<TimedPose> read_tum(const std::filesystem::path& file);

/// Stamps with 6 decimals, positions and quaternions with 9. The file appears whole or not at all.
void write_tum(const std::vector<TimedPose>& trajectory, const std::filesystem::path& file);

}  // namespace crspf
