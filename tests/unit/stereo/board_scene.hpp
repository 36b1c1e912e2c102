// Pictures of a chessboard by a pair of cameras of which everything is known. Its own camera model, written from the
// formulas of the model and not by OpenCV, so that both are held against each other.
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/base/rng.hpp"
#include "drivers/stereo/stereo_calibration.hpp"
#include "platform/files/gray_png.hpp"
#include "tools/calibrate/stereo_estimate.hpp"

namespace crspf::test {

struct Vec3 {
    double x = 0.0;
    double y = 0.0;
    double z = 0.0;

    friend Vec3 operator+(const Vec3& a, const Vec3& b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
    friend Vec3 operator-(const Vec3& a, const Vec3& b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
    friend Vec3 operator*(double s, const Vec3& a) { return {s * a.x, s * a.y, s * a.z}; }
};

inline double dot(const Vec3& a, const Vec3& b) {
    return a.x * b.x + a.y * b.y + a.z * b.z;
}
inline double length(const Vec3& a) {
    return std::sqrt(dot(a, a));
}

/// Row-major.
using Turn = std::array<double, 9>;

inline Vec3 turned(const Turn& R, const Vec3& p) {
    return {dot({R[0], R[1], R[2]}, p), dot({R[3], R[4], R[5]}, p), dot({R[6], R[7], R[8]}, p)};
}
inline Vec3 turned_back(const Turn& R, const Vec3& p) {
    return {dot({R[0], R[3], R[6]}, p), dot({R[1], R[4], R[7]}, p), dot({R[2], R[5], R[8]}, p)};
}

/// About x by a, then about y by b, then about z by c. [rad]
inline Turn turn_of(double a, double b, double c) {
    const double ca = std::cos(a);
    const double sa = std::sin(a);
    const double cb = std::cos(b);
    const double sb = std::sin(b);
    const double cc = std::cos(c);
    const double sc = std::sin(c);
    return {cc * cb,
            cc * sb * sa - sc * ca,
            cc * sb * ca + sc * sa,
            sc * cb,
            sc * sb * sa + cc * ca,
            sc * sb * ca - cc * sa,
            -sb,
            cb * sa,
            cb * ca};
}

/// Where a point of the camera's axes is in the picture.
inline BoardCorner projected(const CameraIntrinsics& c, const Vec3& p) {
    const auto& k = c.distortion;
    const double x = p.x / p.z;
    const double y = p.y / p.z;
    const double r2 = x * x + y * y;
    const double radial = (1.0 + r2 * (k[0] + r2 * (k[1] + r2 * k[4]))) / (1.0 + r2 * (k[5] + r2 * (k[6] + r2 * k[7])));
    return {.x_px = c.cx_px + c.fx_px * (x * radial + 2.0 * k[2] * x * y + k[3] * (r2 + 2.0 * x * x)),
            .y_px = c.cy_px + c.fy_px * (y * radial + k[2] * (r2 + 2.0 * y * y) + 2.0 * k[3] * x * y)};
}

/// The ray of a place in the picture, with z = 1: projected() turned round.
inline Vec3 ray_of(const CameraIntrinsics& c, double x_px, double y_px) {
    const Vec3 begin{(x_px - c.cx_px) / c.fx_px, (y_px - c.cy_px) / c.fy_px, 1.0};
    Vec3 ray = begin;
    for (int i = 0; i < 8; ++i) {
        const BoardCorner at = projected(c, ray);
        ray.x += (x_px - at.x_px) / c.fx_px;
        ray.y += (y_px - at.y_px) / c.fy_px;
    }
    return ray;
}

/// Where the board is, seen from the left camera: its point (x, y, 0) is at place + R (x, y, 0). Its first inner corner
/// is its origin.
struct BoardPlace {
    Turn R{};
    Vec3 place;
};

class BoardScene {
 public:
    static constexpr int kFine = 3;  ///< samples of a pixel, each way

    BoardScene(const StereoCalibration& truth, const Board& board) : truth_(truth), board_(board) {
        left_rays_ = rays_of(truth.left);
        right_rays_ = rays_of(truth.right);
    }

    /// At a place where both cameras see all of it, tilted up to 29 degrees about each axis.
    [[nodiscard]] BoardPlace random_place(Rng& rng, double nearest_m, double furthest_m) const {
        for (;;) {
            BoardPlace at;
            // One after the other: in which order arguments are evaluated is the compiler's choice.
            const double about_z = 0.3 * rng.symmetric();
            const double about_y = 0.5 * rng.symmetric();
            const double about_x = 0.5 * rng.symmetric();
            at.R = turn_of(about_x, about_y, about_z);
            const double z = nearest_m + 0.5 * (furthest_m - nearest_m) * (1.0 + rng.symmetric());
            at.place = {0.8 * z * rng.symmetric(), 0.6 * z * rng.symmetric(), z};
            if (seen(at)) {
                return at;
            }
        }
    }

    [[nodiscard]] GrayImage left(const BoardPlace& at) const { return picture(left_rays_, at.R, at.place); }
    [[nodiscard]] GrayImage right(const BoardPlace& at) const {
        const Vec3 c0 = turned(truth_.R, {at.R[0], at.R[3], at.R[6]});
        const Vec3 c1 = turned(truth_.R, {at.R[1], at.R[4], at.R[7]});
        const Vec3 c2 = turned(truth_.R, {at.R[2], at.R[5], at.R[8]});
        return picture(right_rays_, {c0.x, c1.x, c2.x, c0.y, c1.y, c2.y, c0.z, c1.z, c2.z}, in_right(at.place));
    }

 private:
    [[nodiscard]] Vec3 in_right(const Vec3& p) const {
        return turned(truth_.R, p) + Vec3{truth_.T_m[0], truth_.T_m[1], truth_.T_m[2]};
    }

    [[nodiscard]] std::vector<Vec3> rays_of(const CameraIntrinsics& camera) const {
        std::vector<Vec3> rays;
        for (int y = 0; y < kFine * truth_.height; ++y) {
            for (int x = 0; x < kFine * truth_.width; ++x) {
                // A pixel's middle is at whole numbers.
                rays.push_back(ray_of(camera, (x + 0.5) / kFine - 0.5, (y + 0.5) / kFine - 0.5));
            }
        }
        return rays;
    }

    [[nodiscard]] bool seen(const BoardPlace& at) const {
        constexpr double kMargin_px = 6.0;
        const auto inside = [&](const BoardCorner& c) {
            return c.x_px > kMargin_px && c.y_px > kMargin_px && c.x_px < truth_.width - kMargin_px &&
                   c.y_px < truth_.height - kMargin_px;
        };
        for (const double x : {-1.5, board_.columns + 0.5}) {
            for (const double y : {-1.5, board_.rows + 0.5}) {
                const Vec3 p = at.place + turned(at.R, {x * board_.square_m, y * board_.square_m, 0.0});
                if (p.z < 0.1 || !inside(projected(truth_.left, p)) || !inside(projected(truth_.right, in_right(p)))) {
                    return false;
                }
            }
        }
        return true;
    }

    [[nodiscard]] std::uint8_t shade(double x, double y) const {
        const double column = std::floor(x / board_.square_m) + 1.0;
        const double row = std::floor(y / board_.square_m) + 1.0;
        if (column < -1.0 || row < -1.0 || column > board_.columns + 1.0 || row > board_.rows + 1.0) {
            return 90;  // the wall
        }
        const bool margin = column < 0.0 || row < 0.0 || column > board_.columns || row > board_.rows;
        return margin || std::fmod(column + row, 2.0) != 0.0 ? 220 : 30;
    }

    [[nodiscard]] GrayImage picture(const std::vector<Vec3>& rays, const Turn& R, const Vec3& place) const {
        const Vec3 normal{R[2], R[5], R[8]};
        const double distance = dot(normal, place);
        GrayImage out(truth_.width, truth_.height);
        constexpr auto kSide = static_cast<std::size_t>(kFine);
        const auto width = static_cast<std::size_t>(truth_.width);
        for (std::size_t i = 0; i < out.pixels.size(); ++i) {
            unsigned sum = 0;
            for (std::size_t k = 0; k < kSide * kSide; ++k) {
                const std::size_t row = kSide * (i / width) + k / kSide;
                const std::size_t column = kSide * (i % width) + k % kSide;
                const Vec3& ray = rays[row * kSide * width + column];
                const Vec3 on_board = turned_back(R, distance / dot(normal, ray) * ray - place);
                sum += shade(on_board.x, on_board.y);
            }
            out.pixels[i] = static_cast<std::uint8_t>(sum / (kSide * kSide));
        }
        return out;
    }

    StereoCalibration truth_;
    Board board_;
    std::vector<Vec3> left_rays_;
    std::vector<Vec3> right_rays_;
};

/// Two cameras of 60 degrees that are mounted a little askew, with the distortion of simple lenses.
inline StereoCalibration askew_pair() {
    StereoCalibration c;
    c.width = 480;
    c.height = 360;
    c.left = {
        .fx_px = 412.0, .fy_px = 413.5, .cx_px = 243.0, .cy_px = 176.5, .distortion = {-0.26, 0.08, 0.001, -0.0007}};
    c.right = {
        .fx_px = 409.0, .fy_px = 409.8, .cx_px = 236.2, .cy_px = 183.0, .distortion = {-0.25, 0.07, -0.0008, 0.0005}};
    c.R = turn_of(0.012, -0.02, 0.008);
    c.T_m = {-0.12, 0.0015, -0.002};
    return c;
}

}  // namespace crspf::test
