// Pictures of maps, as PNG.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>
#include <vector>

#include "platform/files/grid_map.hpp"
#include "platform/files/trajectory.hpp"

namespace crspf {

struct Rgb {
    std::uint8_t red = 0;
    std::uint8_t green = 0;
    std::uint8_t blue = 0;

    friend bool operator==(const Rgb&, const Rgb&) = default;
};

/// Row-major from the upper left corner.
struct RgbImage {
    int width = 0;   ///< [px]
    int height = 0;  ///< [px]
    std::vector<Rgb> pixels;

    [[nodiscard]] Rgb& at(int x, int y) {
        return pixels[static_cast<std::size_t>(y) * static_cast<std::size_t>(width) + static_cast<std::size_t>(x)];
    }
};

inline constexpr int kImageSideMax = 8192;  ///< [px]

inline constexpr Rgb kFreeColour{254, 254, 254};
inline constexpr Rgb kUnknownColour{205, 205, 205};
inline constexpr Rgb kOccupiedColour{0, 0, 0};
inline constexpr Rgb kPathColour{33, 102, 172};
inline constexpr Rgb kStartColour{26, 152, 80};
inline constexpr Rgb kEndColour{215, 48, 39};

/// The map, with the path as a line, a disc at its start and one at its end. A map wider or higher than `side_max_px`
/// is reduced by a whole factor; a pixel is as occupied as the most occupied of its cells, so that thin walls stay.
/// The path is clipped at the edge; non-finite poses are left out.
[[nodiscard]] RgbImage draw_map(const GridMap& map, std::span<const TimedPose> path, int side_max_px = kImageSideMax);

/// The bytes of a PNG file. Throws InputError for an image that is empty or larger than kImageSideMax.
[[nodiscard]] std::vector<std::uint8_t> encode_png(const RgbImage& image);

/// The same as a file, which appears whole or not at all. Throws InputError (disk full, unwritable directory ...).
void write_png(const RgbImage& image, const std::filesystem::path& file);

}  // namespace crspf
