#include "tools/sim/stereo_camera.hpp"

#include <algorithm>
#include <cmath>

#include "core/base/trig.hpp"
#include "platform/files/input_error.hpp"
#include "tools/sim/world3d.hpp"

namespace crspf::sim {
namespace {

constexpr double kContrast = 0.3;  // grain's standard deviation, of a surface's brightness
constexpr int kEdgeParts = 32;     // of a pixel's width, to which an edge's place is found
constexpr int kEdgeProbe = 8;      // parts, thinner than which nothing is sure to be seen
constexpr double kSunX = 0.6;      // where light comes from
constexpr double kSunY = 0.8;
constexpr double kSunShare = 0.15;
constexpr double kSkyFade = 60.0;  // [grey levels] darker for each metre of rise a metre
constexpr double kDarkness = 0.02;
constexpr float kBareLight = 150.0F;
constexpr int kBlurShare = 8;  // of the picture's width, over which it is blurred

double brightness(Matter matter) {
    switch (matter) {
        case Matter::kSky: return 225.0;
        case Matter::kFloor: return 95.0;
        case Matter::kCeiling: return 150.0;
        case Matter::kWall: return 135.0;
        case Matter::kPerson: return 70.0;
        case Matter::kCar: return 165.0;
        case Matter::kCrown: return 80.0;
    }
    return 0.0;
}

/// A point of a surface, in axes that move with it.
Point on_surface(const Face& face, Point p, const Movers& movers) {
    // So far apart that no two bodies look alike.
    const Point own{.x_m = 1000.0 + 7.3 * face.index, .y_m = 1000.0};
    if (face.matter == Matter::kPerson) {
        const Point centre = movers.legs[face.index].centre;
        return {own.x_m + p.x_m - centre.x_m, own.y_m + p.y_m - centre.y_m};
    }
    if (face.matter == Matter::kCar) {
        const Point seen = movers.cars[face.index].seen(p);
        return {own.x_m + seen.x_m, own.y_m + seen.y_m};
    }
    return p;
}

/// Each pixel becomes the mean of those about it, as far as the picture goes.
void blur(std::vector<float>& row, int width) {
    const int reach = width / kBlurShare / 2;
    std::vector<double> sums{0.0};
    for (const float value : row) {
        sums.push_back(sums.back() + static_cast<double>(value));
    }
    for (int x = 0; x < width; ++x) {
        const auto from = static_cast<std::size_t>(std::max(x - reach, 0));
        const auto to = static_cast<std::size_t>(std::min(x + reach + 1, width));
        row[static_cast<std::size_t>(x)] = static_cast<float>((sums[to] - sums[from]) / static_cast<double>(to - from));
    }
}

bool alike(std::span<const Sight> a, std::span<const Sight> b) {
    return std::equal(a.begin(), a.end(), b.begin(), b.end(),
                      [](const Sight& s, const Sight& t) { return s.face.continues(t.face); });
}

void check(const CameraMounting& mounting) {
    if (std::abs(mounting.roll_rad) + std::abs(mounting.pitch_rad) > 0.0) {
        throw InputError(
            "[stereo] roll_deg, pitch_deg: the simulated camera stands upright; leave them out to simulate");
    }
    if (!(mounting.z_m > 0.0 && mounting.z_m < World3d::kWallHeight_m)) {
        throw InputError("[stereo] z_m: the simulated camera stands below the tops of the walls, " +
                         std::to_string(World3d::kWallHeight_m) + " m above the ground; give a height in between");
    }
}

}  // namespace

RectifiedCamera usual_camera(int width_px, int height_px) {
    constexpr double kBaseline_m = 0.12;
    return {.width = width_px,
            .height = height_px,
            .focal_px = width_px / 2.0,
            .cx_px = (width_px - 1) / 2.0,
            .cy_px = (height_px - 1) / 2.0,
            .baseline_m = kBaseline_m};
}

StereoCamera::StereoCamera(const Scene& scene, const StereoCameraParams& params, std::uint64_t seed)
    : scene_(&scene),
      params_(params),
      grain_(seed),
      level_grain_(grain_),
      upright_grain_(grain_),
      view_(scene, World3d::kWallHeight_m),
      random_(seed, RandomStream::kCamera),
      light_(static_cast<std::size_t>(params.camera.width) * static_cast<std::size_t>(params.camera.height)) {
    check(params.mounting);
}

StereoPictures StereoCamera::shoot(const Pose2& P_world_base, const Movers& movers, std::optional<Blindness> blind) {
    const Pose2 P_world_left = P_world_base * P_base_camera();
    StereoPictures pictures;
    draw(P_world_left, movers);
    pictures.left = exposed(blind);
    draw(P_world_left * Pose2{.x_m = 0.0, .y_m = -params_.camera.baseline_m, .theta_rad = 0.0}, movers);
    pictures.right = exposed(blind);
    return pictures;
}

StereoCamera::Plane StereoCamera::plane_at(const Pose2& P_world_eye, double at_px) const {
    const SinCos heading = sin_cos(P_world_eye.theta_rad);
    const double left = (params_.camera.cx_px - at_px) / params_.camera.focal_px;
    const double slant = std::sqrt(1.0 + left * left);
    return {.eye = {P_world_eye.x_m, P_world_eye.y_m},
            .direction = {.sin = (heading.sin + left * heading.cos) / slant,
                          .cos = (heading.cos - left * heading.sin) / slant},
            .slant = slant};
}

void StereoCamera::draw(const Pose2& P_world_eye, const Movers& movers) {
    std::fill(light_.begin(), light_.end(), 0.0F);
    const int width = params_.camera.width;
    sights_.clear();
    sight_begin_.assign(1, 0);
    for (int x = 0; x < width; ++x) {
        const Plane plane = plane_at(P_world_eye, x);
        const std::span<const Sight> seen = view_.look(plane.eye, params_.mounting.z_m, plane.direction, movers);
        sights_.insert(sights_.end(), seen.begin(), seen.end());
        sight_begin_.push_back(sights_.size());
    }
    const auto sights_of = [&](int x) {
        const auto i = static_cast<std::size_t>(std::clamp(x, 0, width - 1));
        return std::span(sights_).subspan(sight_begin_[i], sight_begin_[i + 1] - sight_begin_[i]);
    };
    for (int x = 0; x < width; ++x) {
        if (alike(sights_of(x), sights_of(x - 1)) && alike(sights_of(x), sights_of(x + 1))) {
            paint({.number = x, .plane = plane_at(P_world_eye, x)}, sights_of(x), movers);
        } else {
            draw_edge(P_world_eye, x, movers);
        }
    }
}

void StereoCamera::draw_edge(const Pose2& P_world_eye, int x, const Movers& movers) {
    const auto plane = [&](double part) { return plane_at(P_world_eye, x - 0.5 + part / kEdgeParts); };
    const auto look = [&](double part) {
        const Plane at = plane(part);
        return view_.look(at.eye, params_.mounting.z_m, at.direction, movers);
    };
    int begin = 0;
    const auto begin_at = [&](int part) {
        begin = part;
        const std::span<const Sight> seen = look(part + 0.5);
        edge_sights_.assign(seen.begin(), seen.end());
    };
    // Parts in which the same is seen are painted at once.
    const auto paint_until = [&](int end) {
        const double middle = (begin + end) / 2.0;
        paint({.number = x, .plane = plane(middle), .weight = static_cast<double>(end - begin) / kEdgeParts},
              look(middle), movers);
    };
    begin_at(0);
    for (int probe = kEdgeProbe - 1; probe < kEdgeParts; probe += kEdgeProbe) {
        while (!alike(edge_sights_, look(probe + 0.5))) {
            int same = begin;
            int other = probe;
            while (other - same > 1) {
                const int between = (same + other) / 2;
                (alike(edge_sights_, look(between + 0.5)) ? same : other) = between;
            }
            paint_until(other);
            begin_at(other);
        }
    }
    paint_until(kEdgeParts);
}

void StereoCamera::paint(const Column& column, std::span<const Sight> sights, const Movers& movers) {
    for (const Sight& sight : sights) {
        paint(column, sight, movers);
    }
}

void StereoCamera::paint(const Column& column, const Sight& sight, const Movers& movers) {
    const RectifiedCamera& camera = params_.camera;
    const double rows_per_rise = camera.focal_px * column.plane.slant;
    const double top_px = std::max(camera.cy_px - rows_per_rise * sight.high, -0.5);
    const double bottom_px = std::min(camera.cy_px - rows_per_rise * sight.low, camera.height - 0.5);
    if (!(top_px < bottom_px)) {
        return;
    }
    const Face& face = sight.face;
    const double eye_m = params_.mounting.z_m;
    const auto rise_at = [&](double row_px) { return (camera.cy_px - row_px) / rows_per_rise; };
    const auto point_at = [&](double way_m) {
        return on_surface(face,
                          {column.plane.eye.x_m + way_m * column.plane.direction.cos,
                           column.plane.eye.y_m + way_m * column.plane.direction.sin},
                          movers);
    };
    double mean = brightness(face.matter);
    const bool grain = params_.grain && face.matter != Matter::kSky;
    if (face.upright && face.matter != Matter::kSky) {
        mean *= 1.0 + kSunShare * (face.normal.x_m * kSunX + face.normal.y_m * kSunY);
    }
    if (face.upright && grain) {
        const double facing =
            std::abs(face.normal.x_m * column.plane.direction.cos + face.normal.y_m * column.plane.direction.sin);
        // The smaller of its scales, upwards and to the side.
        const double px_per_m = rows_per_rise / face.at_m * std::min(1.0, column.plane.slant * facing);
        upright_grain_.stand_at(point_at(face.at_m), px_per_m, eye_m + face.at_m * rise_at(bottom_px),
                                eye_m + face.at_m * rise_at(top_px));
    }
    if (!face.upright && grain) {
        const Point from = point_at(0.0);
        const Point metre_on = point_at(1.0);
        level_grain_.lead(from, {metre_on.x_m - from.x_m, metre_on.y_m - from.y_m});
    }
    const int first = static_cast<int>(std::floor(top_px + 0.5));
    const int last = std::min(static_cast<int>(std::floor(bottom_px + 0.5)), camera.height - 1);
    lights_.assign(static_cast<std::size_t>(last - first) + 1, mean);
    const auto for_each_row = [&](auto act) {
        for (int y = first; y <= last; ++y) {
            act(lights_[static_cast<std::size_t>(y - first)], rise_at(std::clamp<double>(y, top_px, bottom_px)));
        }
    };
    if (face.matter == Matter::kSky) {
        for_each_row([](double& light, double rise) { light -= kSkyFade * rise; });
    } else if (grain && face.upright) {
        for_each_row([&](double& light, double rise) {
            light *= 1.0 + kContrast * upright_grain_.at(eye_m + face.at_m * rise);
        });
    } else if (grain) {
        level_grain_.clear();
        for_each_row([&](double& /*light*/, double rise) {
            const double way_m = face.at_m / rise;
            // The smaller of its scales, aside and along the way.
            level_grain_.ask(way_m, rows_per_rise / way_m * std::min(1.0, std::abs(rise)));
        });
        const std::span<const float> told = level_grain_.told();
        for (std::size_t i = 0; i < told.size(); ++i) {
            lights_[i] *= 1.0 + kContrast * static_cast<double>(told[i]);
        }
    }
    auto* to = light_.data() + static_cast<std::ptrdiff_t>(first) * camera.width + column.number;
    for (int y = first; y <= last; ++y, to += camera.width) {
        const double covered = std::min(y + 0.5, bottom_px) - std::max(y - 0.5, top_px);
        *to += static_cast<float>(column.weight * covered * lights_[static_cast<std::size_t>(y - first)]);
    }
}

GrayImage StereoCamera::exposed(std::optional<Blindness> blind) {
    const int width = params_.camera.width;
    const int height = params_.camera.height;
    // The difference of two uniform bytes deviates by 104.5.
    const double noise_step = params_.noise / 104.5;
    GrayImage picture(width, height);
    std::vector<float> row(static_cast<std::size_t>(width));
    std::uint64_t bits = 0;
    std::size_t at = 0;
    for (int y = 0; y < height; ++y) {
        const auto begin = light_.begin() + static_cast<std::ptrdiff_t>(at);
        std::copy(begin, begin + width, row.begin());
        if (blind == Blindness::kBare) {
            std::fill(row.begin(), row.end(), kBareLight);
        } else if (blind == Blindness::kBlur) {
            blur(row, width);
        }
        const double gain = blind == Blindness::kDark ? kDarkness : 1.0;
        for (const float value : row) {
            bits = at % 4 == 0 ? random_.next() : bits >> 16U;
            const int difference = static_cast<int>(bits & 0xFFU) - static_cast<int>((bits >> 8U) & 0xFFU);
            const double noisy = gain * static_cast<double>(value) + noise_step * difference + 0.5;
            picture.pixels[at++] = static_cast<std::uint8_t>(std::clamp(noisy, 0.0, 255.0));
        }
    }
    return picture;
}

}  // namespace crspf::sim
