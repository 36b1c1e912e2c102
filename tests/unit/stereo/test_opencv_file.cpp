// Our file of a calibration against OpenCV's own reader and writer.
#include <catch2/catch.hpp>
#include <opencv2/core.hpp>

#include "platform/service/stereo_calibration.hpp"
#include "tests/unit/stereo/board_scene.hpp"

using namespace crspf;

namespace {

cv::Mat read_matrix(const cv::FileStorage& storage, const char* key) {
    cv::Mat matrix;
    storage[key] >> matrix;
    REQUIRE(matrix.type() == CV_64F);
    return matrix;
}

}  // namespace

TEST_CASE("stereo calibration: OpenCV reads what we write") {
    const StereoCalibration c = test::askew_pair();
    const cv::FileStorage storage(write_stereo_calibration(c), cv::FileStorage::READ | cv::FileStorage::MEMORY);
    REQUIRE(storage.isOpened());
    CHECK(static_cast<int>(storage["image_width"]) == 480);
    CHECK(static_cast<int>(storage["image_height"]) == 360);
    const cv::Mat M_left = read_matrix(storage, "M1");
    const cv::Mat M_right = read_matrix(storage, "M2");
    const cv::Mat D_right = read_matrix(storage, "D2");
    const cv::Mat R = read_matrix(storage, "R");
    const cv::Mat T = read_matrix(storage, "T");
    CHECK(cv::norm(M_left, cv::Mat(cv::Matx33d(412.0, 0.0, 243.0, 0.0, 413.5, 176.5, 0.0, 0.0, 1.0))) == 0.0);
    CHECK(M_right.at<double>(1, 2) == 183.0);
    CHECK(D_right.total() == 8);
    CHECK(D_right.at<double>(2) == -0.0008);
    CHECK(R.size() == cv::Size(3, 3));
    CHECK(std::equal(c.R.begin(), c.R.end(), R.begin<double>()));
    CHECK(T.size() == cv::Size(1, 3));
    CHECK(std::equal(c.T_m.begin(), c.T_m.end(), T.begin<double>()));
}

TEST_CASE("stereo calibration: we read what OpenCV writes") {
    const StereoCalibration c = test::askew_pair();
    const auto matrix_of = [](const CameraIntrinsics& i) {
        return cv::Mat(cv::Matx33d(i.fx_px, 0.0, i.cx_px, 0.0, i.fy_px, i.cy_px, 0.0, 0.0, 1.0));
    };
    cv::FileStorage storage(".yml", cv::FileStorage::WRITE | cv::FileStorage::MEMORY);
    storage.writeComment("a pair of cameras: how it sees");
    storage << "calibration_time"
            << "Fri Nov 27 2026";
    storage << "flags"
            << "{"
            << "fixed" << 1 << "names"
            << "["
            << "M1"
            << "M2"
            << "]"
            << "}";
    storage << "M1" << matrix_of(c.left) << "D1" << cv::Mat(1, 5, CV_64F, cv::Scalar(0.125));
    storage << "M2" << matrix_of(c.right) << "D2" << cv::Mat(4, 1, CV_32F, cv::Scalar(-0.25));
    storage << "R" << cv::Mat(cv::Matx33d(c.R.data())) << "T" << cv::Mat(cv::Vec3d(c.T_m.data()));
    storage << "image_width" << c.width << "image_height" << c.height;
    storage << "points" << std::vector<cv::Point2f>{{1.0F, 2.0F}, {3.0F, 4.0F}};
    const StereoCalibration read = parse_stereo_calibration(storage.releaseAndGetString(), "calib");
    CHECK(read.left.fx_px == c.left.fx_px);
    CHECK(read.right.cy_px == c.right.cy_px);
    CHECK(read.left.distortion[4] == 0.125);
    CHECK(read.left.distortion[5] == 0.0);
    CHECK(read.right.distortion[3] == -0.25);
    CHECK(read.right.distortion[4] == 0.0);
    CHECK(read.R == c.R);
    CHECK(read.T_m == c.T_m);
    CHECK(read.width == 480);
    CHECK(read.height == 360);
}
