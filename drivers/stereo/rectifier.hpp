// Pictures of a pair of cameras as they come, brought to matching rows.
#pragma once

#include <memory>
#include <optional>

#include "core/base/gray_image.hpp"
#include "drivers/stereo/calibration_fault.hpp"
#include "drivers/stereo/stereo_calibration.hpp"

namespace crspf {

/// Cuts what both cameras see without black borders, and keeps the size of the pictures (Bouguet's method, by OpenCV).
/// One thread's.
class StereoRectifier {
 public:
    /// Nothing, and why, of a calibration that makes no sense or does not tell the pictures' size. Takes memory for the
    /// tables, as long as it lives.
    [[nodiscard]] static std::optional<StereoRectifier> make(const StereoCalibration& calibration,
                                                             CalibrationFault& fault);
    StereoRectifier(StereoRectifier&& other) noexcept;
    StereoRectifier& operator=(StereoRectifier&& other) noexcept;
    StereoRectifier(const StereoRectifier&) = delete;
    StereoRectifier& operator=(const StereoRectifier&) = delete;
    ~StereoRectifier();

    [[nodiscard]] const RectifiedCamera& camera() const { return camera_; }

    /// Valid until the next call; of a rectified pair the same views. Empty views for pictures that are not of the
    /// calibration's size.
    [[nodiscard]] StereoView rectify(const StereoView& pair);

 private:
    struct Tables;

    StereoRectifier(const RectifiedCamera& camera, std::unique_ptr<Tables> tables);

    RectifiedCamera camera_;
    std::unique_ptr<Tables> tables_;  ///< none: nothing to rectify
};

}  // namespace crspf
