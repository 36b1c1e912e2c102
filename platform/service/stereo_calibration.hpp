// Files that tell how a pair of cameras sees.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "drivers/stereo/stereo_calibration.hpp"

namespace crspf {

/// Two kinds of text, told by their beginning:
///  - OpenCV's YAML ("%YAML:1.0"): camera matrices M1 and M2, distortions D1 and D2 of 4, 5 or 8 coefficients (absent:
///    none), and what takes a point of the left camera's axes to the right one's, R and T in metres. image_width and
///    image_height may be absent. All other keys are skipped. It is what `crspf calibrate stereo` writes.
///  - KITTI's calib.txt: projection matrices of twelve numbers a row, named P0 and P1, or the first two rows without
///    names. They are of rectified pictures.
/// A pair without distortion whose cameras are alike and look the same way is rectified, whatever the kind.
/// Throws InputError, "NAME:LINE: reason; remedy", for what is neither, and for numbers that no pair of cameras has.
/// @param name of the file, for messages
[[nodiscard]] StereoCalibration parse_stereo_calibration(std::string_view text, const std::string& name);

/// The same, of a file. OpenCV's sample writes two, intrinsics.yml and extrinsics.yml: either name reads both.
[[nodiscard]] StereoCalibration read_stereo_calibration(const std::filesystem::path& file);

/// As OpenCV's YAML, to the last bit of each number.
[[nodiscard]] std::string write_stereo_calibration(const StereoCalibration& calibration);

}  // namespace crspf
