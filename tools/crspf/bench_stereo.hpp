// What `crspf bench` measures of stereo odometry.
#pragma once

namespace crspf::cli {

inline constexpr const char* kStereoPair = "stereo/1226x370";

/// Tells Google Benchmark of the case, where the build has OpenCV: pairs of pictures of the simulated campus into
/// motion. Items are pairs.
void register_stereo_cases();

}  // namespace crspf::cli
