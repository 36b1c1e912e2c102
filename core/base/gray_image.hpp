// Pictures of cameras, as views of somebody's pixels.
#pragma once

#include <cstddef>
#include <cstdint>

namespace crspf {

/// 8 bit gray, row-major from the upper left corner.
struct GrayView {
    const std::uint8_t* pixels = nullptr;
    int width = 0;           ///< [px]
    int height = 0;          ///< [px]
    std::size_t stride = 0;  ///< [bytes] from a row to the next
};

/// What both cameras saw at one moment; of one size.
struct StereoView {
    GrayView left;
    GrayView right;
};

}  // namespace crspf
