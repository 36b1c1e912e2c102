#include <catch2/catch.hpp>
#include <cmath>
#include <cstdio>
#include <opencv2/calib3d.hpp>
#include <opencv2/core.hpp>
#include <string>
#include <vector>

#include "drivers/stereo/rectifier.hpp"
#include "platform/capture/pcapng_writer.hpp"
#include "platform/capture/stereo_record.hpp"
#include "platform/files/input_error.hpp"
#include "tests/unit/platform/scratch.hpp"
#include "tests/unit/stereo/board_scene.hpp"
#include "tools/crspf/calibrate_stereo.hpp"

using namespace crspf;

namespace {

constexpr Board kBoard{.columns = 9, .rows = 6, .square_m = 0.025};

std::string text_of(const std::vector<std::uint8_t>& bytes) {
    return {bytes.begin(), bytes.end()};
}

std::string error_of(const StereoCalibrateJob& job) {
    try {
        static_cast<void>(run_stereo_calibration(job));
    } catch (const InputError& e) {
        return e.what();
    }
    return "";
}

/// [px] by how much the disparity of a far point is wrong, at the worst place, when the pictures of `truth` are
/// rectified by what was found: what decides about ranges of 10 m and more.
double far_error_px(const StereoCalibration& truth, const StereoCalibration& found) {
    const auto matrix_of = [](const CameraIntrinsics& c) {
        return cv::Matx33d(c.fx_px, 0.0, c.cx_px, 0.0, c.fy_px, c.cy_px, 0.0, 0.0, 1.0);
    };
    const auto distortion_of = [](const CameraIntrinsics& c) { return cv::Vec<double, 8>(c.distortion.data()); };
    cv::Matx33d R_left;
    cv::Matx33d R_right;
    cv::Matx34d P_left;
    cv::Matx34d P_right;
    cv::Matx44d Q;
    cv::stereoRectify(matrix_of(found.left), distortion_of(found.left), matrix_of(found.right),
                      distortion_of(found.right), cv::Size(found.width, found.height), cv::Matx33d(found.R.data()),
                      cv::Vec3d(found.T_m.data()), R_left, R_right, P_left, P_right, Q, cv::CALIB_ZERO_DISPARITY, 0.0);
    double worst = 0.0;
    for (const double x : {-0.35, 0.0, 0.35}) {
        for (const double y : {-0.25, 0.0, 0.25}) {
            const test::Vec3 direction{x, y, 1.0};
            const auto rectified = [&](const CameraIntrinsics& true_camera, const test::Vec3& p,
                                       const CameraIntrinsics& c, const cv::Matx33d& R, const cv::Matx34d& P) {
                const BoardCorner at = test::projected(true_camera, p);
                std::vector<cv::Point2d> point{{at.x_px, at.y_px}};
                cv::undistortPoints(point, point, matrix_of(c), distortion_of(c), R, P);
                return point[0].x;
            };
            worst = std::max(worst, std::abs(rectified(truth.left, direction, found.left, R_left, P_left) -
                                             rectified(truth.right, test::turned(truth.R, direction), found.right,
                                                       R_right, P_right)));
        }
    }
    return worst;
}

/// 20 pairs, and one without a board, as left00.png, right00.png ...
void write_pictures(const test::Scratch& scratch, const test::BoardScene& scene, Rng& rng) {
    for (int i = 0; i < 20; ++i) {
        const test::BoardPlace place = scene.random_place(rng, 0.35, 0.8);
        const std::string number = std::to_string(10 + i);
        scratch.file("left" + number + ".png", text_of(encode_gray_png(scene.left(place).view())));
        scratch.file("right" + number + ".png", text_of(encode_gray_png(scene.right(place).view())));
    }
    const GrayImage nothing(480, 360);
    scratch.file("left99.png", text_of(encode_gray_png(nothing.view())));
    scratch.file("right99.png", text_of(encode_gray_png(nothing.view())));
}

}  // namespace

TEST_CASE("calibrate stereo: what cameras of which everything is known are found to be") {
    const StereoCalibration truth = test::askew_pair();
    const test::BoardScene scene(truth, kBoard);
    const test::Scratch scratch;
    Rng rng(1);
    write_pictures(scratch, scene, rng);
    StereoCalibrateJob job{.inputs = {scratch.directory()}, .board = kBoard, .progress = {}};
    std::size_t calls = 0;
    job.progress = [&](std::size_t looked_at, std::size_t /*used*/) {
        ++calls;
        CHECK(looked_at == calls);
    };
    const StereoCalibrateOutcome outcome = run_stereo_calibration(job);
    const StereoEstimate& e = outcome.estimate;
    CHECK(calls == 21);
    CHECK(outcome.looked_at == 21);
    REQUIRE_FALSE(outcome.without_board.empty());
    CHECK(outcome.without_board.back().ends_with("left99.png"));
    CHECK(e.pairs.size() + outcome.without_board.size() == 21);
    CHECK(e.pairs.size() >= 18);  // OpenCV overlooks some
    CHECK(outcome.doubts.empty());
    std::printf("fx %.2f +- %.2f (%.1f), %.2f +- %.2f (%.1f) px; baseline %.5f +- %.5f (%.5f) m; rows %.3f px\n",
                e.left.value.fx_px, e.left.stddev.fx_px, truth.left.fx_px, e.right.value.fx_px, e.right.stddev.fx_px,
                truth.right.fx_px, e.baseline_m, e.baseline_stddev_m, std::hypot(0.12, 0.0015, 0.002), e.rows_px);

    CHECK(e.left.value.fx_px == Approx(truth.left.fx_px).epsilon(0.005));
    CHECK(e.left.value.fy_px == Approx(truth.left.fy_px).epsilon(0.005));
    CHECK(e.right.value.fx_px == Approx(truth.right.fx_px).epsilon(0.005));
    CHECK(e.right.value.fy_px == Approx(truth.right.fy_px).epsilon(0.005));
    CHECK(std::abs(e.left.value.cx_px - truth.left.cx_px) < 2.0);
    CHECK(std::abs(e.right.value.cy_px - truth.right.cy_px) < 2.0);
    CHECK(std::abs(e.left.value.distortion[0] - truth.left.distortion[0]) < 0.03);
    CHECK(e.baseline_m == Approx(std::hypot(0.12, 0.0015, 0.002)).epsilon(0.01));
    for (std::size_t i = 0; i < 9; ++i) {
        CHECK(std::abs(e.calibration.R[i] - truth.R[i]) < 0.003);
    }
    CHECK(e.rows_px < 0.3);
    CHECK(e.left.rms_px < 0.3);
    CHECK(e.left.stddev.fx_px > 0.0);
    CHECK(std::abs(e.left.value.fx_px - truth.left.fx_px) < 5.0 * e.left.stddev.fx_px + 0.2);

    const double far_px = far_error_px(truth, e.calibration);
    std::printf("disparity of far points wrong by up to %.3f px\n", far_px);
    CHECK(far_px < 0.1);  // 0.12 without the fit of all at once

    // Pictures that had no part in it.
    CalibrationFault fault = CalibrationFault::kNone;
    auto rectifier = StereoRectifier::make(e.calibration, fault);
    REQUIRE(rectifier);
    for (int i = 0; i < 3; ++i) {
        const test::BoardPlace place = scene.random_place(rng, 0.4, 0.7);
        const GrayImage left = scene.left(place);
        const GrayImage right = scene.right(place);
        const StereoView pair = rectifier->rectify({.left = left.view(), .right = right.view()});
        const auto l = find_board(pair.left, kBoard);
        const auto r = find_board(pair.right, kBoard);
        REQUIRE(l.size() == 54);
        REQUIRE(r.size() == 54);
        double sum = 0.0;
        for (std::size_t k = 0; k < l.size(); ++k) {
            sum += (l[k].y_px - r[k].y_px) * (l[k].y_px - r[k].y_px);
        }
        CHECK(std::sqrt(sum / 54.0) < 0.3);
    }

    {  // left and right exchanged
        const test::Scratch other;
        for (int i = 10; i < 30; ++i) {
            const std::string number = std::to_string(i);
            other.file("left" + number + ".png", test::content_of(scratch / ("right" + number + ".png")));
            other.file("right" + number + ".png", test::content_of(scratch / ("left" + number + ".png")));
        }
        CHECK(error_of({.inputs = {other.directory()}, .board = kBoard, .progress = {}})
                  .find("exchange the left and right pictures") != std::string::npos);
    }
    {  // too few, another board, and a partner that is missing
        const test::Scratch few;
        for (int i = 10; i < 15; ++i) {
            for (const char* side : {"left", "right"}) {
                const std::string name = side + std::to_string(i) + ".png";
                few.file(name, test::content_of(scratch / name));
            }
        }
        CHECK(error_of({.inputs = {few.directory()}, .board = kBoard, .progress = {}})
                  .find("seen whole by both cameras in 5 pairs, and 8 are needed") != std::string::npos);
        CHECK(error_of(
                  {.inputs = {few.directory()}, .board = {.columns = 8, .rows = 5, .square_m = 0.025}, .progress = {}})
                  .find("no board of 8x5 inner corners is seen whole by both cameras in any of 5 pairs") !=
              std::string::npos);
        few.file("left77.png", test::content_of(few / "left10.png"));
        CHECK(
            error_of({.inputs = {few.directory()}, .board = kBoard, .progress = {}}).find("right77.png, is missing") !=
            std::string::npos);
        few.file("right77.png", text_of(encode_gray_png(GrayImage(48, 36).view())));
        CHECK(error_of({.inputs = {few.directory()}, .board = kBoard, .progress = {}})
                  .find("left77.png: 48x36 pixels, others have 480x360; ") != std::string::npos);
    }
    {  // a pair that is of another moment is named
        scratch.file("right13.png", test::content_of(scratch / "right14.png"));
        const StereoCalibrateOutcome spoilt =
            run_stereo_calibration({.inputs = {scratch.directory()}, .board = kBoard, .progress = {}});
        REQUIRE_FALSE(spoilt.worst.empty());
        CHECK(std::any_of(spoilt.worst.begin(), spoilt.worst.end(),
                          [](const std::string& name) { return name.ends_with("left13.png"); }));
    }
}

TEST_CASE("calibrate stereo: a board that was only in the middle is said so") {
    const StereoCalibration truth = test::askew_pair();
    const test::BoardScene scene(truth, kBoard);
    const test::Scratch scratch;
    Rng rng(5);
    std::filesystem::create_directory(scratch / "image_0");
    std::filesystem::create_directory(scratch / "image_1");
    for (int i = 0; i < 9; ++i) {
        test::BoardPlace place = scene.random_place(rng, 0.6, 0.7);
        const test::Vec3 half = test::turned(place.R, {0.1, 0.0625, 0.0});
        place.place = test::Vec3{0.06, 0.0, 0.7} - half;
        const std::string name = std::to_string(i) + ".png";
        scratch.file("image_0/" + name, text_of(encode_gray_png(scene.left(place).view())));
        scratch.file("image_1/" + name, text_of(encode_gray_png(scene.right(place).view())));
    }
    const StereoCalibrateOutcome outcome =
        run_stereo_calibration({.inputs = {scratch.directory()}, .board = kBoard, .progress = {}});
    REQUIRE_FALSE(outcome.doubts.empty());
    CHECK(outcome.doubts[0].find("the board was seen only in ") != std::string::npos);
    CHECK(outcome.doubts[0].find("hold the board into their corners, too") != std::string::npos);
}

TEST_CASE("calibrate stereo: pairs of a recording, each place of the board once") {
    const StereoCalibration truth = test::askew_pair();
    const test::BoardScene scene(truth, kBoard);
    const test::Scratch scratch;
    std::vector<std::uint8_t> file;
    REQUIRE(pcapng::append_section(file, ""));
    REQUIRE(pcapng::append_source(file, {.name = "camera", .description = "", .link = LinkKind::kStereo}));
    Rng rng(9);
    Stamp stamp{1'700'000'000'000'000'000};
    for (int i = 0; i < 9; ++i) {
        const test::BoardPlace place = scene.random_place(rng, 0.35, 0.8);
        std::vector<std::uint8_t> pair;
        const std::vector<std::uint8_t> left = encode_gray_png(scene.left(place).view());
        const std::vector<std::uint8_t> right = encode_gray_png(scene.right(place).view());
        append_stereo_record(pair, {.left_png = left, .right_png = right});
        // Twice within half a second, and once more.
        for (const int milliseconds : {0, 300, 700}) {
            REQUIRE(pcapng::append_record(file, {.source = 0,
                                                 .link = LinkKind::kStereo,
                                                 .direction = Direction::kReceived,
                                                 .stamp = stamp + Duration{milliseconds * 1'000'000LL},
                                                 .bytes = pair}));
        }
        stamp = stamp + Duration{2'000'000'000};
    }
    const auto path = scratch.file("run.pcapng", text_of(file));
    const StereoCalibrateOutcome outcome = run_stereo_calibration({.inputs = {path}, .board = kBoard, .progress = {}});
    CHECK(outcome.looked_at == 18);
    CHECK(outcome.not_moved == 9);
    CHECK(outcome.estimate.pairs.size() == 9);
    CHECK(outcome.estimate.pairs[1].name.ends_with("run.pcapng: pair 4"));
    CHECK(outcome.estimate.baseline_m == Approx(0.12).epsilon(0.02));
}

TEST_CASE("calibrate stereo: inputs without pairs") {
    const test::Scratch scratch;
    CHECK(error_of({.inputs = {scratch.directory()}, .board = kBoard, .progress = {}})
              .find("no pairs of PNG pictures; name them") != std::string::npos);
    CHECK(error_of({.inputs = {scratch / "none"}, .board = kBoard, .progress = {}}).find("none: cannot be read") !=
          std::string::npos);
    std::vector<std::uint8_t> file;
    REQUIRE(pcapng::append_section(file, ""));
    const auto path = scratch.file("empty.pcapng", text_of(file));
    CHECK(error_of({.inputs = {path}, .board = kBoard, .progress = {}}).find("a recording without pictures; ") !=
          std::string::npos);
    scratch.file("left1.png", "no picture");
    scratch.file("right1.png", "no picture");
    CHECK(error_of({.inputs = {scratch.directory()}, .board = kBoard, .progress = {}}).find("left1.png: ") !=
          std::string::npos);
}
