// Pairs of pictures in folders and recordings.
#pragma once

#include <filesystem>
#include <functional>
#include <string>

#include "core/base/gray_image.hpp"
#include "core/base/time.hpp"

namespace crspf {

struct NamedPair {
    std::string name;  ///< of the left picture's file, or the record's place in the recording
    StereoView view;   ///< valid during the call
    Stamp stamp;       ///< of a recording
    bool recorded = false;
    double share = 0.0;  ///< of the input that is read, 0 to 1
};

/// A folder holds left*.png and right*.png, or the folders image_0 and image_1 (or image_l and image_r, left and right)
/// with the same names in both; a recording holds pairs (LinkKind::kStereo). Each in the order of names or of time.
/// Of a recording, only pairs at least `spacing` apart.
/// Throws InputError for an input without pairs, for pictures without a partner, and for what cannot be read.
void for_each_pair(const std::filesystem::path& input, Duration spacing,
                   const std::function<void(const NamedPair&)>& visit);

}  // namespace crspf
