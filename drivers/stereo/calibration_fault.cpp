#include "drivers/stereo/calibration_fault.hpp"

#include <algorithm>
#include <array>
#include <cmath>  // abs, isfinite, sqrt
#include <cstddef>

namespace crspf {
namespace {

constexpr double kFocalMost_px = 1e5;
constexpr double kCentreMost_px = 2.0 * kPictureSideMax;
constexpr double kDistortionMost = 1e3;
constexpr double kRadiusMost = 10.0;  // tangent of 84 degrees
constexpr int kRadiusSteps = 10'000;
constexpr double kTurnLeastCosine = 0.7071;  // of 45 degrees
constexpr double kRotationError = 1e-3;      // files of few digits
constexpr double kBaselineLeast_m = 5e-3;
constexpr double kBaselineMost_m = 10.0;
constexpr double kSameIntrinsics_px = 1e-3;
constexpr double kOffRowMost = 0.02;  // of the baseline; KITTI's colour cameras have 0.005

bool within(double value, double most) {
    return std::isfinite(value) && std::abs(value) <= most;
}

bool sound(const CameraIntrinsics& c) {
    const bool pinhole = within(c.fx_px, kFocalMost_px) && within(c.fy_px, kFocalMost_px) && c.fx_px > 0.0 &&
                         c.fy_px > 0.0 && within(c.cx_px, kCentreMost_px) && within(c.cy_px, kCentreMost_px);
    return pinhole &&
           std::all_of(c.distortion.begin(), c.distortion.end(), [](double k) { return within(k, kDistortionMost); });
}

/// The distortion, but for its small tangential part, takes a ray to each place up to `most`, and further out with each
/// step: it can be turned round there. Radii are of focal lengths.
bool reaches(const CameraIntrinsics& c, double most) {
    const auto& k = c.distortion;
    double before = 0.0;
    for (int step = 1; step <= kRadiusSteps; ++step) {
        const double r = kRadiusMost * step / kRadiusSteps;
        const double r2 = r * r;
        const double distorted =
            r * (1.0 + r2 * (k[0] + r2 * (k[1] + r2 * k[4]))) / (1.0 + r2 * (k[5] + r2 * (k[6] + r2 * k[7])));
        if (!(distorted > before)) {
            return false;
        }
        if (distorted >= most) {
            return true;
        }
        before = distorted;
    }
    return false;
}

/// Up to the nearest side of the picture; the corners of a calibration are often worse.
bool sees_picture(const CameraIntrinsics& c, const StereoCalibration& pair) {
    const double half_px = 0.5 * std::min(pair.width, pair.height);
    return reaches(c, (half_px > 0.0 ? half_px : std::min(std::abs(c.cx_px), std::abs(c.cy_px))) / c.fx_px);
}

/// Orthonormal, right-handed, and by less than 45 degrees.
bool is_small_rotation(const std::array<double, 9>& R) {
    for (std::size_t i = 0; i < 3; ++i) {
        for (std::size_t j = i; j < 3; ++j) {
            const double dot = R[3 * i] * R[3 * j] + R[3 * i + 1] * R[3 * j + 1] + R[3 * i + 2] * R[3 * j + 2];
            if (!within(dot - (i == j ? 1.0 : 0.0), kRotationError)) {
                return false;
            }
        }
    }
    // A reflection's diagonal does not reach so far.
    return 0.5 * (R[0] + R[4] + R[8] - 1.0) > kTurnLeastCosine;
}

/// Of a pair that is said to be rectified.
bool rows_match(const StereoCalibration& c) {
    const auto same = [](double a, double b) { return std::abs(a - b) <= kSameIntrinsics_px; };
    return same(c.left.fx_px, c.left.fy_px) && same(c.left.fx_px, c.right.fx_px) && same(c.left.fy_px, c.right.fy_px) &&
           same(c.left.cx_px, c.right.cx_px) && same(c.left.cy_px, c.right.cy_px) &&
           std::max(std::abs(c.T_m[1]), std::abs(c.T_m[2])) <= kOffRowMost * std::abs(c.T_m[0]);
}

}  // namespace

CalibrationFault fault_of(const StereoCalibration& calibration) {
    const StereoCalibration& c = calibration;
    if (c.width < 0 || c.height < 0 || c.width > kPictureSideMax || c.height > kPictureSideMax) {
        return CalibrationFault::kSize;
    }
    if (!sound(c.left) || !sees_picture(c.left, c)) {
        return CalibrationFault::kLeftCamera;
    }
    if (!sound(c.right) || !sees_picture(c.right, c)) {
        return CalibrationFault::kRightCamera;
    }
    if (!is_small_rotation(c.R)) {
        return CalibrationFault::kRotation;
    }
    const auto& T = c.T_m;
    const double distance_m = std::sqrt(T[0] * T[0] + T[1] * T[1] + T[2] * T[2]);
    if (!(distance_m >= kBaselineLeast_m && distance_m <= kBaselineMost_m)) {
        return CalibrationFault::kBaseline;
    }
    if (!(-T[0] > std::abs(T[1]) && -T[0] > std::abs(T[2]))) {
        return CalibrationFault::kNotToTheRight;
    }
    return c.rectified && !rows_match(c) ? CalibrationFault::kNotRectified : CalibrationFault::kNone;
}

const char* text_of(CalibrationFault fault) {
    switch (fault) {
        case CalibrationFault::kNone: break;
        case CalibrationFault::kSize: return "the size of the pictures is not told, or more than 8192 pixels a side";
        case CalibrationFault::kLeftCamera:
            return "no lens has the focal length, centre or distortion of the left camera";
        case CalibrationFault::kRightCamera:
            return "no lens has the focal length, centre or distortion of the right camera";
        case CalibrationFault::kRotation: return "what turns the right camera is no rotation by less than 45 degrees";
        case CalibrationFault::kBaseline: return "the cameras are not 5 mm to 10 m apart; distances are in metres";
        case CalibrationFault::kNotToTheRight: return "the second camera is not to the right of the first";
        case CalibrationFault::kNotRectified: return "pictures are said to be rectified, and their rows do not match";
        case CalibrationFault::kNothingLeft: return "after rectification nothing is left that both cameras see";
    }
    return "nothing is wrong";
}

}  // namespace crspf
