// The stereo camera on the robot: where it is, and how it sees.
#pragma once

#include <cstdint>
#include <string>

#include "drivers/stereo/stereo_params.hpp"

namespace crspf {

struct StereoConfig {
    StereoParams odometry;
    std::string device;            ///< V4L2: /dev/video...
    std::string right_device;      ///< empty: `device` gives both pictures side by side
    std::uint32_t width_px = 640;  ///< of each picture
    std::uint32_t height_px = 480;
    double rate_hz = 15.0;
    /// Path that the process can open; empty: pictures are rectified, and a recording's folder tells the rest.
    std::string calibration;
    std::string calibration_text;  ///< the file's content in its place: recordings carry it
};

}  // namespace crspf
