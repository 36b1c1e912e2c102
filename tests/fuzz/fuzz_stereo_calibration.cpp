// Whatever the bytes of a calibration file: one that a pair of cameras can have and that survives being written, or an
// InputError that names the line.
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <string>
#include <string_view>

#include "drivers/stereo/calibration_fault.hpp"
#include "platform/files/input_error.hpp"
#include "platform/service/stereo_calibration.hpp"

namespace {

using namespace crspf;

void require(bool promise) {
    if (!promise) {
        std::abort();
    }
}

bool same(const CameraIntrinsics& a, const CameraIntrinsics& b) {
    return a.fx_px == b.fx_px && a.fy_px == b.fy_px && a.cx_px == b.cx_px && a.cy_px == b.cy_px &&
           a.distortion == b.distortion;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    const std::string text(data, data + size);
    try {
        const StereoCalibration read = parse_stereo_calibration(text, "fuzz");
        require(fault_of(read) == CalibrationFault::kNone);
        const StereoCalibration again = parse_stereo_calibration(write_stereo_calibration(read), "written");
        require(same(read.left, again.left) && same(read.right, again.right) && read.R == again.R);
        require(read.T_m == again.T_m && read.width == again.width && read.height == again.height);
    } catch (const InputError& e) {
        const std::string_view what = e.what();
        require(what.starts_with("fuzz:") && what.size() > 5 && what[5] >= '0' && what[5] <= '9');
    }
    return 0;
}
