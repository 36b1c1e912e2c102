#include "platform/files/png_image.hpp"

#include <png.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <string>

#include "platform/files/atomic_file.hpp"
#include "platform/files/input_error.hpp"

namespace crspf {
namespace {

static_assert(sizeof(Rgb) == 3, "libpng is handed the pixels as they lie in memory");

constexpr double kFarAway_px = 1e9;  // beyond, a pose is nonsense and would spoil the arithmetic

struct Point {
    double x;  // [px] to the right
    double y;  // [px] down
};

Rgb colour(GridCell cell) {
    switch (cell) {
        case GridCell::kFree: return kFreeColour;
        case GridCell::kOccupied: return kOccupiedColour;
        case GridCell::kUnknown: break;
    }
    return kUnknownColour;
}

// What a reduced pixel shows: a wall hides the floor, the floor hides the unknown.
GridCell strongest(const GridMap& map, int column, int row, int factor) {
    GridCell cell = GridCell::kUnknown;
    for (int r = row; r < std::min(row + factor, map.height); ++r) {
        for (int c = column; c < std::min(column + factor, map.width); ++c) {
            cell = std::max(cell, map.at(c, r));
        }
    }
    return cell;
}
static_assert(GridCell::kUnknown < GridCell::kFree && GridCell::kFree < GridCell::kOccupied);

// The part of the interval [from, to] of a line's parameter where start + u * step lies in [0, end).
void clip(double start, double step, double end, double& from, double& to) {
    if (step == 0.0) {
        to = start >= 0.0 && start < end ? to : -1.0;
        return;
    }
    const double u0 = -start / step;
    const double u1 = (end - start) / step;
    from = std::max(from, std::min(u0, u1));
    to = std::min(to, std::max(u0, u1));
}

void draw_line(RgbImage& image, Point a, Point b, Rgb ink) {
    double from = 0.0;
    double to = 1.0;
    clip(a.x, b.x - a.x, image.width, from, to);
    clip(a.y, b.y - a.y, image.height, from, to);
    if (!(from <= to)) {
        return;
    }
    // Clipped, the line is no longer than the image, wherever its ends were.
    const double dx = b.x - a.x;
    const double dy = b.y - a.y;
    const int steps = 1 + static_cast<int>((to - from) * std::max(std::abs(dx), std::abs(dy)));
    for (int i = 0; i <= steps; ++i) {
        const double u = from + (to - from) * i / steps;
        const int x = std::clamp(static_cast<int>(a.x + u * dx), 0, image.width - 1);
        const int y = std::clamp(static_cast<int>(a.y + u * dy), 0, image.height - 1);
        image.at(x, y) = ink;
    }
}

void draw_disc(RgbImage& image, Point centre, int radius_px, Rgb ink) {
    if (!(centre.x >= 0.0 && centre.y >= 0.0 && centre.x < image.width && centre.y < image.height)) {
        return;
    }
    const int cx = static_cast<int>(centre.x);
    const int cy = static_cast<int>(centre.y);
    for (int y = std::max(cy - radius_px, 0); y <= std::min(cy + radius_px, image.height - 1); ++y) {
        for (int x = std::max(cx - radius_px, 0); x <= std::min(cx + radius_px, image.width - 1); ++x) {
            if ((x - cx) * (x - cx) + (y - cy) * (y - cy) <= radius_px * radius_px) {
                image.at(x, y) = ink;
            }
        }
    }
}

// `what` begins the text of an error.
std::vector<std::uint8_t> encode(const RgbImage& image, const std::string& what) {
    if (image.width <= 0 || image.height <= 0 || image.width > kImageSideMax || image.height > kImageSideMax) {
        throw InputError(what + ": an image of " + std::to_string(image.width) + " x " + std::to_string(image.height) +
                         " px cannot be written; its sides may be 1 to " + std::to_string(kImageSideMax) + " px");
    }
    png_image png{};
    png.version = PNG_IMAGE_VERSION;
    png.width = static_cast<png_uint_32>(image.width);
    png.height = static_cast<png_uint_32>(image.height);
    png.format = PNG_FORMAT_RGB;
    png_alloc_size_t size = PNG_IMAGE_PNG_SIZE_MAX(png);
    std::vector<std::uint8_t> bytes(size);
    if (png_image_write_to_memory(&png, bytes.data(), &size, 0, image.pixels.data(), 0, nullptr) == 0) {
        throw InputError(what + ": cannot be written: " + png.message + "; write a smaller image");
    }
    bytes.resize(size);
    return bytes;
}

}  // namespace

RgbImage draw_map(const GridMap& map, std::span<const TimedPose> path, int side_max_px) {
    const int side_max = std::clamp(side_max_px, 1, kImageSideMax);
    const int factor = std::max(1, (std::max(map.width, map.height) + side_max - 1) / side_max);
    RgbImage image;
    image.width = (map.width + factor - 1) / factor;
    image.height = (map.height + factor - 1) / factor;
    image.pixels.resize(static_cast<std::size_t>(image.width) * static_cast<std::size_t>(image.height));
    for (int y = 0; y < image.height; ++y) {
        for (int x = 0; x < image.width; ++x) {
            image.at(x, y) = colour(strongest(map, x * factor, (image.height - 1 - y) * factor, factor));
        }
    }

    const Pose2 P_origin_map = inverse(map.P_map_origin);
    const double pixel_m = map.resolution_m * factor;
    std::optional<Point> first;
    std::optional<Point> last;
    for (const TimedPose& pose : path) {
        const Pose2 P_origin_base = P_origin_map * pose.P_map_base;
        const Point point{P_origin_base.x_m / pixel_m, image.height - P_origin_base.y_m / pixel_m};
        if (!(std::abs(point.x) < kFarAway_px && std::abs(point.y) < kFarAway_px)) {
            continue;
        }
        draw_line(image, last.value_or(point), point, kPathColour);
        first = first.value_or(point);
        last = point;
    }
    if (first && last) {
        const int radius_px = std::max(2, std::max(image.width, image.height) / 150);
        draw_disc(image, *first, radius_px, kStartColour);
        draw_disc(image, *last, radius_px, kEndColour);
    }
    return image;
}

std::vector<std::uint8_t> encode_png(const RgbImage& image) {
    return encode(image, "PNG");
}

void write_png(const RgbImage& image, const std::filesystem::path& file) {
    // Into memory and then to the file: libpng leaves through longjmp when a write fails, we leave by exception.
    const std::vector<std::uint8_t> bytes = encode(image, file.string());
    AtomicFile out(file);
    // NOLINTNEXTLINE(cppcoreguidelines-pro-type-reinterpret-cast): bytes as the characters of a file
    out.write({reinterpret_cast<const char*>(bytes.data()), bytes.size()});
    out.commit();
}

}  // namespace crspf
