// Gray pictures and PNG, in memory.
#pragma once

#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

#include "core/base/gray_image.hpp"

namespace crspf {

/// Owns its pixels.
struct GrayImage {
    int width = 0;   ///< [px]
    int height = 0;  ///< [px]
    std::vector<std::uint8_t> pixels;

    GrayImage() = default;
    GrayImage(int w, int h) : width(w), height(h), pixels(static_cast<std::size_t>(w) * static_cast<std::size_t>(h)) {}

    [[nodiscard]] GrayView view() const {
        return {.pixels = pixels.data(), .width = width, .height = height, .stride = static_cast<std::size_t>(width)};
    }
    /// Part of it: columns [x, x + w).
    [[nodiscard]] GrayView columns(int x, int w) const {
        return {.pixels = pixels.data() + x, .width = w, .height = height, .stride = static_cast<std::size_t>(width)};
    }
};

inline constexpr int kGraySideMax = 4096;  ///< [px]

/// Colours become gray, 16 bit become 8. Throws InputError "NAME: reason" for what is no PNG, is damaged or is wider or
/// higher than kGraySideMax.
[[nodiscard]] GrayImage decode_gray_png(std::span<const std::uint8_t> bytes, std::string_view name);

/// Quick rather than small. The view must not be empty.
[[nodiscard]] std::vector<std::uint8_t> encode_gray_png(const GrayView& image);

}  // namespace crspf
