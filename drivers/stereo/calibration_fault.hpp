// Whether a pair of cameras can be as its calibration says.
#pragma once

#include <cstdint>

#include "drivers/stereo/stereo_calibration.hpp"

namespace crspf {

enum class CalibrationFault : std::uint8_t {
    kNone,
    kSize,           ///< of the pictures: not told where it must be, or more than kPictureSideMax
    kLeftCamera,     ///< a focal length, a centre or a distortion that no lens has
    kRightCamera,    ///< the same
    kRotation,       ///< R is no rotation, or turns by more than 45 degrees
    kBaseline,       ///< T is not 5 mm to 10 m
    kNotToTheRight,  ///< the second camera is not beside the first, to its right
    kNotRectified,   ///< said to be rectified, and the rows do not match
    kNothingLeft,    ///< no part of the pictures is seen by both cameras after rectification
};

inline constexpr int kPictureSideMax = 8192;  ///< [px]

/// The first that is found. Pictures' sizes may be 0, not told; kNothingLeft is not looked for.
[[nodiscard]] CalibrationFault fault_of(const StereoCalibration& calibration);

/// In English, to stand behind the name of the file.
[[nodiscard]] const char* text_of(CalibrationFault fault);

}  // namespace crspf
