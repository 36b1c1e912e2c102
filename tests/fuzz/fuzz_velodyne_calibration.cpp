// Whatever the bytes of a db.xml: corrections that a sensor can have, or an InputError that names the line. The first
// byte of the input chooses the model.
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <string>
#include <string_view>

#include "core/base/real.hpp"
#include "platform/files/input_error.hpp"
#include "platform/service/velodyne_calibration.hpp"

namespace {

using namespace crspf;

void require(bool promise) {
    if (!promise) {
        std::abort();
    }
}

void check(const VelodyneCalibration& calibration) {
    for (const VelodyneLaser& l : calibration) {
        require(absolute(l.vertical_rad) < 1.5709 && absolute(l.rotation_rad) < 3.1416);
        require(absolute(l.distance_m) <= 10.0 && absolute(l.distance_x_m) <= 10.0 && absolute(l.distance_y_m) <= 10.0);
        require(absolute(l.vertical_offset_m) <= 1.0 && absolute(l.horizontal_offset_m) <= 1.0);
        require(l.focal_distance_m >= 0.0 && l.focal_distance_m <= 131.0 && absolute(l.focal_slope) <= 100.0);
        require(l.min_intensity <= l.max_intensity);
    }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    if (size == 0) {
        return 0;
    }
    const std::string text(data + 1, data + size);
    try {
        check(parse_velodyne_calibration(text, "fuzz.xml", static_cast<VelodyneModel>(data[0] % 6)));
    } catch (const InputError& e) {
        const std::string_view what = e.what();
        require(what.starts_with("fuzz.xml:") && what.size() > 9 && what[9] >= '1' && what[9] <= '9');
    }
    return 0;
}
