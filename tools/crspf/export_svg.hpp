// Path over map as a drawing, with a scale.
#pragma once

#include <filesystem>
#include <span>

#include "platform/files/grid_map.hpp"
#include "platform/files/trajectory.hpp"

namespace crspf {

inline constexpr int kPictureSide_px = 2000;  ///< of a picture of a map, at most

/// The map as a picture in it, the path as lines, its start and its end, and a bar of a round number of metres. A unit
/// of the drawing is a metre. Throws InputError for a file that cannot be written.
void write_svg(const GridMap& map, std::span<const TimedPose> path, const std::filesystem::path& file);

}  // namespace crspf
