// A small world for a stereo camera: boards that face it, one beside the other at different distances, all painted.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <vector>

#include "core/base/gray_image.hpp"
#include "drivers/stereo/stereo_calibration.hpp"
#include "tests/unit/drivers/stereo/scatter.hpp"

namespace crspf::test {

inline constexpr RectifiedCamera kCamera{
    .width = 480, .height = 270, .focal_px = 240.0, .cx_px = 240.0, .cy_px = 135.0, .baseline_m = 0.12};

struct Pictures {
    std::vector<std::uint8_t> left;
    std::vector<std::uint8_t> right;

    [[nodiscard]] StereoView view() const {
        const auto one = [](const std::vector<std::uint8_t>& pixels) {
            return GrayView{.pixels = pixels.data(),
                            .width = kCamera.width,
                            .height = kCamera.height,
                            .stride = static_cast<std::size_t>(kCamera.width)};
        };
        return {.left = one(left), .right = one(right)};
    }
};

/// Where the camera is, in its own axes at the start; it never turns. [m]
struct Place {
    double x = 0.0;
    double z = 0.0;
};

class PaintedRoom {
 public:
    enum class Paint : std::uint8_t { kSpots, kStripes, kNone };

    Paint paint = Paint::kSpots;
    double light = 1.0;
    double noise = 1.5;    ///< [grey levels] standard deviation
    double crowd_m = 0.0;  ///< how far the boards of the crowd are shifted to the right
    int crowd_boards = 0;  ///< so many of the five belong to it

    [[nodiscard]] Pictures seen_from(Place place, unsigned picture) const {
        return {.left = render(place, picture * 2),
                .right = render({place.x + kCamera.baseline_m, place.z}, picture * 2 + 1)};
    }

 private:
    static constexpr std::array<double, 5> kDepth_m{2.5, 5.0, 3.5, 6.0, 4.5};
    static constexpr double kBoard_m = 1.0;  // of width for each metre of distance, so that each fills its part

    static double value(std::int64_t x, std::int64_t y) {
        auto h = static_cast<std::uint64_t>(x) * 0x9E3779B97F4A7C15ULL ^
                 static_cast<std::uint64_t>(y) * 0xC2B2AE3D27D4EB4FULL;
        h ^= h >> 31U;
        h *= 0xD6E8FEB86659FD93ULL;
        h ^= h >> 32U;
        return static_cast<double>(h & 0xFFFFU) / 65535.0;
    }
    /// Between the corners of a lattice, without a bend.
    static double smooth(double x, double y) {
        const double fx = std::floor(x);
        const double fy = std::floor(y);
        const auto ease = [](double t) { return t * t * (3.0 - 2.0 * t); };
        const double u = ease(x - fx);
        const double v = ease(y - fy);
        const auto ix = static_cast<std::int64_t>(fx);
        const auto iy = static_cast<std::int64_t>(fy);
        return (value(ix, iy) * (1.0 - u) + value(ix + 1, iy) * u) * (1.0 - v) +
               (value(ix, iy + 1) * (1.0 - u) + value(ix + 1, iy + 1) * u) * v;
    }

    [[nodiscard]] double paint_at(double x_m, double y_m, std::size_t board) const {
        constexpr double kSpotsPerMetre = 12.0;
        constexpr double kStripesPerMetre = 8.0;
        constexpr double kTurn = 6.283185307179586;
        switch (paint) {
            case Paint::kSpots: {
                const double away = 100.0 * static_cast<double>(board);
                return 0.6 * smooth(kSpotsPerMetre * x_m + away, kSpotsPerMetre * y_m) +
                       0.4 * smooth(4.0 * x_m + away, 4.0 * y_m);
            }
            case Paint::kStripes:
                return 0.5 + 0.4 * std::sin(kTurn * kStripesPerMetre * x_m) * std::sin(kTurn * kStripesPerMetre * y_m);
            case Paint::kNone: break;
        }
        return 0.5;
    }

    [[nodiscard]] std::vector<std::uint8_t> render(Place place, unsigned picture) const {
        Rng random(picture + 1);
        std::vector<std::uint8_t> pixels;
        pixels.reserve(static_cast<std::size_t>(kCamera.width) * static_cast<std::size_t>(kCamera.height));
        for (int v = 0; v < kCamera.height; ++v) {
            for (int u = 0; u < kCamera.width; ++u) {
                const double dx = (u - kCamera.cx_px) / kCamera.focal_px;
                const double dy = (v - kCamera.cy_px) / kCamera.focal_px;
                // The nearest board whose width the ray meets; behind them all a wall.
                double depth_m = 8.0 - place.z;
                std::size_t board = kDepth_m.size();
                for (std::size_t i = 0; i < kDepth_m.size(); ++i) {
                    const double away_m = kDepth_m.at(i) - place.z;
                    const double middle_m = (static_cast<double>(i) - 2.0) * 0.42 * kDepth_m.at(i) + shift_of(i);
                    if (away_m > 0.2 && away_m < depth_m &&
                        std::abs(place.x + dx * away_m - middle_m) < 0.17 * kBoard_m * kDepth_m.at(i)) {
                        depth_m = away_m;
                        board = i;
                    }
                }
                const double on_board_m = board < kDepth_m.size() ? shift_of(board) : 0.0;
                const double grey = 40.0 + 170.0 * paint_at(place.x + dx * depth_m - on_board_m, dy * depth_m, board);
                pixels.push_back(
                    static_cast<std::uint8_t>(std::clamp(light * grey + noise * scatter(random) + 0.5, 0.0, 255.0)));
            }
        }
        return pixels;
    }

    [[nodiscard]] double shift_of(std::size_t board) const {
        return board < static_cast<std::size_t>(crowd_boards) ? crowd_m : 0.0;
    }
};

}  // namespace crspf::test
