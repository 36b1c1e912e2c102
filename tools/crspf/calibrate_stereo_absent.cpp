#include "platform/files/input_error.hpp"
#include "tools/crspf/calibrate_stereo.hpp"

namespace crspf {

StereoCalibrateOutcome run_stereo_calibration(const StereoCalibrateJob& /*job*/) {
    throw InputError(
        "crspf: built without OpenCV, which finds the board; install libopencv-calib3d-dev and libopencv-video-dev and "
        "build again");
}

}  // namespace crspf
