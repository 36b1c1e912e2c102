#include <catch2/catch.hpp>

#include "platform/files/input_error.hpp"
#include "platform/service/stereo_input.hpp"

using namespace crspf;

TEST_CASE("stereo: a build without OpenCV says what it lacks") {
    CHECK_THROWS_AS(make_stereo_input({}), InputError);
    CHECK_THROWS_WITH(make_stereo_input({}), Catch::Contains("libopencv-video-dev"));
}
