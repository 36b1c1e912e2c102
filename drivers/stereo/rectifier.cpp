#include "drivers/stereo/rectifier.hpp"

#include <algorithm>
#include <cmath>  // abs, isfinite
#include <opencv2/calib3d.hpp>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>
#include <utility>

// OpenCV throws where its arguments are wrong, and here nobody catches: they are right before it is called.

namespace crspf {
namespace {

// Of the focal length before, and of the pictures' longer side.
constexpr double kFocalLeast = 0.05;
constexpr double kFocalMost = 20.0;
constexpr double kCentreMost = 20.0;

bool within(double value, double most) {
    return std::isfinite(value) && std::abs(value) <= most;
}

cv::Matx33d camera_matrix(const CameraIntrinsics& c) {
    return {c.fx_px, 0.0, c.cx_px, 0.0, c.fy_px, c.cy_px, 0.0, 0.0, 1.0};
}

cv::Vec<double, 8> distortion(const CameraIntrinsics& c) {
    return cv::Vec<double, 8>(c.distortion.data());
}

/// OpenCV's of somebody's pixels. It does not write to what it reads.
cv::Mat mat_of(const GrayView& view) {
    // NOLINTNEXTLINE(cppcoreguidelines-pro-type-const-cast): cv::Mat knows no read-only pixels
    return {view.height, view.width, CV_8UC1, const_cast<std::uint8_t*>(view.pixels), view.stride};
}

GrayView view_of(const cv::Mat& mat) {
    return {.pixels = mat.data, .width = mat.cols, .height = mat.rows, .stride = mat.step[0]};
}

}  // namespace

struct StereoRectifier::Tables {
    /// Where each pixel of a rectified picture comes from, and the picture.
    struct Table {
        cv::Mat whole;
        cv::Mat fraction;
        cv::Mat picture;
    };

    Table left;
    Table right;
};

StereoRectifier::StereoRectifier(const RectifiedCamera& camera, std::unique_ptr<Tables> tables)
    : camera_(camera), tables_(std::move(tables)) {}
StereoRectifier::StereoRectifier(StereoRectifier&& other) noexcept = default;
StereoRectifier& StereoRectifier::operator=(StereoRectifier&& other) noexcept = default;
StereoRectifier::~StereoRectifier() = default;

std::optional<StereoRectifier> StereoRectifier::make(const StereoCalibration& calibration, CalibrationFault& fault) {
    fault = fault_of(calibration);
    if (fault == CalibrationFault::kNone && (calibration.width == 0 || calibration.height == 0)) {
        fault = CalibrationFault::kSize;
    }
    if (fault != CalibrationFault::kNone) {
        return std::nullopt;
    }
    const StereoCalibration& c = calibration;
    RectifiedCamera camera{.width = c.width,
                           .height = c.height,
                           .focal_px = c.left.fx_px,
                           .cx_px = c.left.cx_px,
                           .cy_px = c.left.cy_px,
                           .baseline_m = -c.T_m[0]};
    if (c.rectified) {
        return StereoRectifier(camera, nullptr);
    }
    const cv::Size size(c.width, c.height);
    cv::Matx33d R_left;
    cv::Matx33d R_right;
    cv::Matx34d P_left;
    cv::Matx34d P_right;
    cv::Matx44d Q;
    cv::stereoRectify(camera_matrix(c.left), distortion(c.left), camera_matrix(c.right), distortion(c.right), size,
                      cv::Matx33d(c.R.data()), cv::Vec3d(c.T_m.data()), R_left, R_right, P_left, P_right, Q,
                      cv::CALIB_ZERO_DISPARITY, 0.0);
    camera.focal_px = P_left(0, 0);
    camera.cx_px = P_left(0, 2);
    camera.cy_px = P_left(1, 2);
    camera.baseline_m = -P_right(0, 3) / P_right(0, 0);
    const double side = std::max(c.width, c.height);
    // What a lens of wild distortion leaves is a strip, or none.
    const bool sees = std::isfinite(camera.focal_px) && camera.focal_px > kFocalLeast * c.left.fx_px &&
                      camera.focal_px < kFocalMost * c.left.fx_px && within(camera.cx_px, kCentreMost * side) &&
                      within(camera.cy_px, kCentreMost * side) && camera.baseline_m > 0.0;
    if (!sees) {
        fault = CalibrationFault::kNothingLeft;
        return std::nullopt;
    }
    auto tables = std::make_unique<Tables>();
    const auto fill = [&](const CameraIntrinsics& from, const cv::Matx33d& R, const cv::Matx34d& P,
                          Tables::Table& table) {
        cv::initUndistortRectifyMap(camera_matrix(from), distortion(from), R, P, size, CV_16SC2, table.whole,
                                    table.fraction);
        table.picture.create(size, CV_8UC1);
    };
    fill(c.left, R_left, P_left, tables->left);
    fill(c.right, R_right, P_right, tables->right);
    return StereoRectifier(camera, std::move(tables));
}

StereoView StereoRectifier::rectify(const StereoView& pair) {
    const auto fits = [&](const GrayView& view) {
        return view.pixels != nullptr && view.width == camera_.width && view.height == camera_.height &&
               view.stride >= static_cast<std::size_t>(view.width);
    };
    if (!fits(pair.left) || !fits(pair.right)) {
        return {};
    }
    if (!tables_) {
        return pair;
    }
    for (const auto& [view, table] : {std::pair{&pair.left, &tables_->left}, std::pair{&pair.right, &tables_->right}}) {
        cv::remap(mat_of(*view), table->picture, table->whole, table->fraction, cv::INTER_LINEAR, cv::BORDER_CONSTANT);
    }
    return {.left = view_of(tables_->left.picture), .right = view_of(tables_->right.picture)};
}

}  // namespace crspf
