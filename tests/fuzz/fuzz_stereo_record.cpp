// Whatever a recording holds as a pair of pictures: two whole pictures, or a clear no.
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <optional>
#include <vector>

#include "platform/capture/stereo_record.hpp"
#include "platform/files/gray_png.hpp"
#include "platform/files/input_error.hpp"

namespace {

void require(bool promise) {
    if (!promise) {
        std::abort();
    }
}

void check(const crspf::GrayImage& image) {
    require(image.width > 0 && image.width <= crspf::kGraySideMax);
    require(image.height > 0 && image.height <= crspf::kGraySideMax);
    require(image.pixels.size() == static_cast<std::size_t>(image.width) * static_cast<std::size_t>(image.height));
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    const std::optional<crspf::StereoRecord> record = crspf::split_stereo_record({data, size});
    if (!record) {
        return 0;
    }
    std::vector<std::uint8_t> again;
    crspf::append_stereo_record(again, *record);
    require(again.size() == size && std::equal(again.begin(), again.end(), data));
    try {
        check(crspf::decode_gray_png(record->left_png, "left"));
        check(crspf::decode_gray_png(record->right_png, "right"));
    } catch (const crspf::InputError&) {
        return 0;
    }
    return 0;
}
