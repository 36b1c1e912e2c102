// A folder of pairs of pictures, laid out as KITTI's odometry benchmark does, read as a recording.
#pragma once

#include <filesystem>
#include <memory>

#include "platform/capture/capture_reader.hpp"

namespace crspf {

/// Whether it is a directory with a folder for each camera: image_0 and image_1, image_2 and image_3, image_l and
/// image_r, or left and right.
[[nodiscard]] bool is_stereo_folder(const std::filesystem::path& directory);

/// One source, "stereo"; its records are pairs of equally named PNG files, in the order of their names. A line of
/// times.txt tells the seconds of each; without it they are 0.1 s apart, as KITTI's are about.
/// Throws InputError: a picture without its other, no pictures, too few or unusable lines in times.txt, a pair larger
/// than a record can be.
[[nodiscard]] std::unique_ptr<CaptureReader> open_stereo_folder(const std::filesystem::path& directory);

/// Where its calibration is, in KITTI's format; empty where there is none.
[[nodiscard]] std::filesystem::path calibration_of(const std::filesystem::path& directory);

}  // namespace crspf
