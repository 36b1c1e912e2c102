// How a pair of cameras sees.
#pragma once

#include <array>

namespace crspf {

/// Of one camera: a pinhole with the distortion that OpenCV calls k1 k2 p1 p2 k3 k4 k5 k6. [px]
struct CameraIntrinsics {
    double fx_px = 0.0;
    double fy_px = 0.0;
    double cx_px = 0.0;
    double cy_px = 0.0;
    std::array<double, 8> distortion{};
};

/// A pair as it is mounted. Optical axes: x right, y down, z forward.
struct StereoCalibration {
    int width = 0;   ///< [px] of each picture; 0: not told
    int height = 0;  ///< [px]
    CameraIntrinsics left;
    CameraIntrinsics right;
    /// A point of the left camera's axes seen from the right one: R p + T. R row-major, T in metres.
    std::array<double, 9> R{1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0};
    std::array<double, 3> T_m{};

    /// Pictures come without distortion and with matching rows: nothing to rectify.
    bool rectified = false;
};

/// A pair of pictures in which the rows match: both cameras look the same way, the right one `baseline_m` to the right.
struct RectifiedCamera {
    int width = 0;   ///< [px]
    int height = 0;  ///< [px]
    double focal_px = 0.0;
    double cx_px = 0.0;
    double cy_px = 0.0;
    double baseline_m = 0.0;
};

}  // namespace crspf
