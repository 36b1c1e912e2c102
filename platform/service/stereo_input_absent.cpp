// In place of stereo_input.cpp where the build found no OpenCV.
#include "platform/files/input_error.hpp"
#include "platform/service/stereo_input.hpp"

namespace crspf {

std::unique_ptr<StereoInput> make_stereo_input(const StereoConfig& /*config*/) {
    throw InputError(
        "stereo: this program was built without OpenCV, which visual odometry needs; install libopencv-video-dev and "
        "libopencv-calib3d-dev, and build it again");
}

}  // namespace crspf
