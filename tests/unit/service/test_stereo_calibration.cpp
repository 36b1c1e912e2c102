#include <catch2/catch.hpp>
#include <limits>
#include <string>

#include "platform/files/input_error.hpp"
#include "platform/service/stereo_calibration.hpp"
#include "tests/unit/platform/scratch.hpp"

using namespace crspf;

namespace {

// As OpenCV's stereo_calib writes its two files, with what else it puts there.
constexpr const char* kIntrinsics = R"(%YAML:1.0
---
M1: !!opencv-matrix
   rows: 3
   cols: 3
   dt: d
   data: [ 5.3400000000000000e+02, 0., 3.4217000000000002e+02, 0.,
       5.3350000000000000e+02, 2.3499000000000001e+02, 0., 0., 1. ]
D1: !!opencv-matrix
   rows: 1
   cols: 5
   dt: d
   data: [ -2.8000000000000003e-01, 7.0000000000000007e-02,
       1.2999999999999999e-03, -0.0002, 1.5e-02 ]
M2: !!opencv-matrix
   rows: 3
   cols: 3
   dt: d
   data: [ 5.3700000000000000e+02, 0., 3.2667000000000002e+02, 0.,
       5.3650000000000000e+02, 2.4999000000000001e+02, 0., 0., 1. ]
D2: !!opencv-matrix
   rows: 1
   cols: 14
   dt: d
   data: [ -0.29, 0.1, 0., 0.0005, 0., 0.5, 0., -0.125, 0., 0., 0., 0., 0., 0. ]
)";
constexpr const char* kExtrinsics = R"(%YAML:1.0
---
R: !!opencv-matrix
   rows: 3
   cols: 3
   dt: d
   data: [ 0.9998, -0.02, 0., 0.02, 0.9998, 0., 0., 0., 1. ]
T: !!opencv-matrix
   rows: 3
   cols: 1
   dt: d
   data: [ -8.3299999999999999e-02, 1e-03, 0.002 ]
R1: !!opencv-matrix
   rows: 3
   cols: 3
   dt: d
   data: [ 1., 0., 0.,
       0., 1., 0., 0., 0., 1. ]
names: [ "a: b", c ]
sizes:
   - 1
   - { width: 2 }
list:
- 3
)";

constexpr const char* kKitti =
    "P0: 7.070912000000e+02 0 6.018873000000e+02 0.000000000000e+00 0 7.070912000000e+02 1.831104000000e+02 0 0 0 1 0\n"
    "P1: 7.070912000000e+02 0 6.018873000000e+02 -3.798145000000e+02 0 7.070912000000e+02 1.831104000000e+02 0 0 0 1 "
    "0\n"
    "\n"
    "Tr: 4.276802385584e-04 -9.999672484946e-01\n";

std::string one_file() {
    return std::string(kIntrinsics)
        .append(std::string(kExtrinsics).substr(14))
        .append("image_width: 640\r\n")
        .append("image_height: 480\n");
}

/// The first of it replaced.
std::string with(std::string text, const std::string& what, const std::string& instead) {
    const std::size_t at = text.find(what);
    REQUIRE(at != std::string::npos);
    return text.replace(at, what.size(), instead);
}

std::string error_of(const std::string& text) {
    try {
        static_cast<void>(parse_stereo_calibration(text, "calib"));
    } catch (const InputError& e) {
        return e.what();
    }
    return "";
}

}  // namespace

TEST_CASE("stereo calibration: OpenCV's file, in one") {
    const StereoCalibration c = parse_stereo_calibration(one_file(), "calib");
    CHECK(c.width == 640);
    CHECK(c.height == 480);
    CHECK(c.left.fx_px == 534.0);
    CHECK(c.left.fy_px == 533.5);
    CHECK(c.left.cx_px == 342.17);
    CHECK(c.left.cy_px == 234.99);
    CHECK(c.left.distortion == std::array<double, 8>{-0.28, 0.07, 0.0013, -0.0002, 0.015, 0.0, 0.0, 0.0});
    CHECK(c.right.fx_px == 537.0);
    CHECK(c.right.distortion == std::array<double, 8>{-0.29, 0.1, 0.0, 0.0005, 0.0, 0.5, 0.0, -0.125});
    CHECK(c.R[1] == -0.02);
    CHECK(c.R[3] == 0.02);
    CHECK(c.T_m == std::array<double, 3>{-0.0833, 0.001, 0.002});
    CHECK_FALSE(c.rectified);
}

TEST_CASE("stereo calibration: OpenCV's two files, by either name") {
    const test::Scratch scratch;
    const auto intrinsics = scratch.file("intrinsics.yml", kIntrinsics);
    CHECK_THROWS_AS(read_stereo_calibration(intrinsics), InputError);  // alone
    const auto extrinsics = scratch.file("extrinsics.yml", kExtrinsics);
    for (const auto& file : {intrinsics, extrinsics}) {
        const StereoCalibration c = read_stereo_calibration(file);
        CHECK(c.left.fx_px == 534.0);
        CHECK(c.T_m[0] == -0.0833);
        CHECK(c.width == 0);
    }
    // What is wrong in the other file is said of that one.
    scratch.file("extrinsics.yml", with(kExtrinsics, "-8.3299999999999999e-02", "-83.3"));
    CHECK_THROWS_WITH(read_stereo_calibration(intrinsics), Catch::Contains("extrinsics.yml:8: T: the cameras are not"));
}

TEST_CASE("stereo calibration: KITTI's calib.txt") {
    const std::string bare = with(with(kKitti, "P0: ", ""), "P1: ", "");
    for (const std::string& text : {std::string(kKitti), bare.substr(0, bare.find("\n\n"))}) {
        const StereoCalibration c = parse_stereo_calibration(text, "calib");
        CHECK(c.rectified);
        CHECK(c.left.fx_px == 707.0912);
        CHECK(c.right.cx_px == 601.8873);
        CHECK(c.right.cy_px == 183.1104);
        CHECK(c.T_m[0] == Approx(-0.53715).epsilon(1e-5));
        CHECK(c.width == 0);
    }
}

TEST_CASE("stereo calibration: what was written is read, to the last bit") {
    StereoCalibration c = parse_stereo_calibration(one_file(), "calib");
    c.left.fx_px = 1000.0 / 3.0;
    c.left.cx_px = 1e-7;
    const StereoCalibration read = parse_stereo_calibration(write_stereo_calibration(c), "calib");
    CHECK(read.left.fx_px == c.left.fx_px);
    CHECK(read.left.cx_px == c.left.cx_px);
    CHECK(read.left.distortion == c.left.distortion);
    CHECK(read.right.distortion == c.right.distortion);
    CHECK(read.right.fy_px == c.right.fy_px);
    CHECK(read.R == c.R);
    CHECK(read.T_m == c.T_m);
    CHECK(read.width == 640);
    CHECK(read.height == 480);
    CHECK_FALSE(read.rectified);

    const StereoCalibration kitti = parse_stereo_calibration(kKitti, "calib");
    CHECK(parse_stereo_calibration(write_stereo_calibration(kitti), "calib").rectified);
}

TEST_CASE("stereo calibration: damage to OpenCV's file is named with its line and key") {
    const std::string text = one_file();
    CHECK(error_of(text).empty());
    const auto breaks = [&](const std::string& what, const std::string& instead, const std::string& said) {
        INFO(what << " -> " << instead << ": " << error_of(with(text, what, instead)));
        CHECK(error_of(with(text, what, instead)).starts_with("calib:" + said));
        CHECK(error_of(with(text, what, instead)).find("; give a file that") != std::string::npos);
    };
    breaks("M1:", "M9:", "1: M1 is missing");
    breaks("R:", "Rx:", "1: R is missing");
    breaks("D2:", "D1:", "21: \"D1\" stands twice");
    breaks("---\n", "---\n   x\n", "3: no key before");
    breaks("M2: ", "M2 ", "15: neither \"key: value\"");
    breaks("cols: 3", "cols: 4", "3: M1 does not hold 3 x 4 numbers");
    breaks("rows: 3", "rows: 99999999999", "3: M1 has no elements");
    breaks("rows: 3", "rows: 4294967297", "3: M1 has no elements, or more than 64");
    breaks("rows: 3", "rows: -3", "3: M1 is no matrix");
    breaks("dt: d", "dt: u", "3: M1 is no matrix");
    breaks("!!opencv-matrix", "", "3: M1 is no matrix");
    breaks("0., 1. ]", "0., 1., 1. ]", "3: M1 does not hold 3 x 3");
    breaks("0., 1. ]", "0., 1.", "3: M1 does not hold 3 x 3");
    breaks("0., 1. ]", "0., .Nan ]", "3: M1 does not hold 3 x 3");
    breaks("0., 1. ]", "0., nan ]", "3: M1 does not hold 3 x 3");
    breaks("0., 1. ]", "0.1, 1. ]", "3: M1 is no camera matrix");
    breaks("5.34", "-5.34", "3: M1: no lens has");
    breaks("5.3700000000000000e+02", "0.", "15: M2: no lens has");
    breaks("0.9998, -0.02", "0.9998, 0.02", "26: R: what turns the right camera");
    breaks("-8.3299999999999999e-02", "8.3299999999999999e-02", "31: T: the second camera is not to the right");
    breaks("-8.3299999999999999e-02", "-83.3", "31: T: the cameras are not 5 mm to 10 m apart");
    breaks("cols: 5", "cols: 6", "9: D1 does not hold");
    breaks("-0.125, 0.", "-0.125, 0.1", "21: D2 is not 4, 5 or 8 coefficients");
    breaks("-2.8000000000000003e-01", "-2.8e+10", "3: M1: no lens has");
    breaks("640", "sixty", "48: image_width is no whole number");
    breaks("640", "64000", "48: image_width: the size of the pictures");
    breaks("640", "-640", "48: image_width: the size of the pictures");
}

TEST_CASE("stereo calibration: damage to KITTI's file is named with its line") {
    const auto breaks = [](const std::string& text, const std::string& said) {
        INFO(error_of(text));
        CHECK(error_of(text).starts_with("calib:" + said));
        CHECK(error_of(text).find("; give KITTI's") != std::string::npos);
    };
    breaks("", "0: P0 is missing");
    breaks("<xml/>", "1: neither");
    breaks(with(kKitti, "P1:", "P2:"), "4: P1 is missing");
    breaks(with(kKitti, "P1:", "P0:"), "2: P0 stands twice");
    breaks(with(kKitti, " 1 0\n", " 1\n"), "1: not twelve numbers");
    breaks(with(kKitti, " 1 0\n", " 1 0 0\n"), "1: not twelve numbers");
    breaks(with(kKitti, " 1 0\n", " 1 nan\n"), "1: not twelve numbers");
    breaks(with(kKitti, " 1 0\n", " 2 0\n"), "4: not the projection of a rectified camera");
    breaks(with(kKitti, "-3.798145", "3.798145"), "4: the second camera is not to the right");
    breaks(with(kKitti, "-3.798145000000e+02", "-0.1"), "4: the cameras are not 5 mm");
    breaks(with(kKitti, "P0: 7.07", "P0: 7.08"), "4: pictures are said to be rectified");
    breaks(with(kKitti, "P0: 7.07", "P0: -7.07"), "4: no lens has");
}
