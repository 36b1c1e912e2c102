// What a stereo camera saw at one instant.
#pragma once

#include "platform/files/gray_png.hpp"

namespace crspf::sim {

/// Of one size.
struct StereoPictures {
    GrayImage left;
    GrayImage right;
};

}  // namespace crspf::sim
