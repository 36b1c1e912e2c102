#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <limits>

#include "drivers/stereo/rectifier.hpp"
#include "tests/unit/stereo/board_scene.hpp"

using namespace crspf;

namespace {

constexpr Board kBoard{.columns = 9, .rows = 6, .square_m = 0.025};

CalibrationFault fault_of_made(const StereoCalibration& calibration) {
    CalibrationFault fault = CalibrationFault::kNone;
    const bool made = StereoRectifier::make(calibration, fault).has_value();
    CHECK(made == (fault == CalibrationFault::kNone));
    return fault;
}

StereoCalibration straight_pair() {
    StereoCalibration c;
    c.width = 32;
    c.height = 24;
    c.left = {.fx_px = 30.0, .fy_px = 30.0, .cx_px = 16.5, .cy_px = 11.0, .distortion = {}};
    c.right = c.left;
    c.T_m = {-0.25, 0.0, 0.0};
    c.rectified = true;
    return c;
}

}  // namespace

TEST_CASE("rectifier: rows match, and distances are the true ones") {
    const StereoCalibration truth = test::askew_pair();
    CalibrationFault fault = CalibrationFault::kNone;
    auto rectifier = StereoRectifier::make(truth, fault);
    REQUIRE(rectifier);
    const RectifiedCamera camera = rectifier->camera();
    CHECK(camera.width == truth.width);
    CHECK(camera.height == truth.height);
    CHECK(camera.baseline_m == Approx(std::hypot(0.12, 0.0015, 0.002)).epsilon(1e-6));

    const test::BoardScene scene(truth, kBoard);
    Rng rng(3);
    double rows_before = 0.0;
    for (int i = 0; i < 3; ++i) {
        const test::BoardPlace place = scene.random_place(rng, 0.5, 0.7);
        const GrayImage left = scene.left(place);
        const GrayImage right = scene.right(place);
        const StereoView pair = rectifier->rectify({.left = left.view(), .right = right.view()});
        const auto l = find_board(pair.left, kBoard);
        const auto r = find_board(pair.right, kBoard);
        REQUIRE(l.size() == 54);
        REQUIRE(r.size() == 54);
        const auto unrectified_l = find_board(left.view(), kBoard);
        const auto unrectified_r = find_board(right.view(), kBoard);
        std::vector<test::Vec3> points;
        double sum = 0.0;
        double squares = 0.0;
        for (std::size_t k = 0; k < l.size(); ++k) {
            const double difference = l[k].y_px - r[k].y_px;
            sum += difference;
            squares += difference * difference;
            rows_before = std::max(rows_before, std::abs(unrectified_l[k].y_px - unrectified_r[k].y_px));
            const double z = camera.focal_px * camera.baseline_m / (l[k].x_px - r[k].x_px);
            points.push_back({z * (l[k].x_px - camera.cx_px) / camera.focal_px,
                              z * (l[k].y_px - camera.cy_px) / camera.focal_px, z});
        }
        CHECK(std::abs(sum) / 54.0 < 0.03);
        CHECK(std::sqrt(squares / 54.0) < 0.12);
        // Corner to corner over the whole board.
        const auto apart = [&](std::size_t a, std::size_t b) { return test::length(points[a] - points[b]); };
        CHECK(apart(0, 8) == Approx(8 * 0.025).epsilon(0.01));
        CHECK(apart(45, 53) == Approx(8 * 0.025).epsilon(0.01));
        CHECK(apart(0, 45) == Approx(5 * 0.025).epsilon(0.01));
    }
    CHECK(rows_before > 3.0);  // there was something to do
}

TEST_CASE("rectifier: pictures of a rectified pair pass as they are") {
    CalibrationFault fault = CalibrationFault::kNone;
    auto rectifier = StereoRectifier::make(straight_pair(), fault);
    REQUIRE(rectifier);
    CHECK(rectifier->camera().focal_px == 30.0);
    CHECK(rectifier->camera().cx_px == 16.5);
    CHECK(rectifier->camera().baseline_m == 0.25);
    const GrayImage picture(64, 24);
    const StereoView pair{.left = picture.columns(0, 32), .right = picture.columns(32, 32)};
    const StereoView out = rectifier->rectify(pair);
    CHECK(out.left.pixels == pair.left.pixels);
    CHECK(out.right.pixels == pair.right.pixels);
    CHECK(out.right.stride == 64);
}

TEST_CASE("rectifier: pictures of another size give none") {
    for (const StereoCalibration& calibration : {straight_pair(), test::askew_pair()}) {
        CalibrationFault fault = CalibrationFault::kNone;
        auto rectifier = StereoRectifier::make(calibration, fault);
        REQUIRE(rectifier);
        const GrayImage good(calibration.width, calibration.height);
        const GrayImage other(calibration.width, calibration.height - 1);
        CHECK(rectifier->rectify({.left = good.view(), .right = good.view()}).right.width == calibration.width);
        CHECK(rectifier->rectify({.left = good.view(), .right = other.view()}).left.pixels == nullptr);
        CHECK(rectifier->rectify({.left = other.view(), .right = good.view()}).left.pixels == nullptr);
        CHECK(rectifier->rectify({.left = {}, .right = good.view()}).right.pixels == nullptr);
        GrayView folded = good.view();
        folded.stride -= 1;
        CHECK(rectifier->rectify({.left = folded, .right = good.view()}).left.pixels == nullptr);
    }
}

TEST_CASE("rectifier: a calibration that makes no sense is refused, and why") {
    constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
    const StereoCalibration good = test::askew_pair();
    CHECK(fault_of_made(good) == CalibrationFault::kNone);
    const auto with = [&](auto change) {
        StereoCalibration c = good;
        change(c);
        return fault_of_made(c);
    };
    using C = StereoCalibration;
    using Fault = CalibrationFault;
    CHECK(with([](C& c) { c.width = 0; }) == Fault::kSize);
    CHECK(with([](C& c) { c.height = -1; }) == Fault::kSize);
    CHECK(with([](C& c) { c.width = 8193; }) == Fault::kSize);
    CHECK(with([](C& c) { c.left.fx_px = 0.0; }) == Fault::kLeftCamera);
    CHECK(with([](C& c) { c.left.fy_px = -400.0; }) == Fault::kLeftCamera);
    CHECK(with([](C& c) { c.right.fx_px = kNan; }) == Fault::kRightCamera);
    CHECK(with([](C& c) { c.right.cx_px = 1e9; }) == Fault::kRightCamera);
    CHECK(with([](C& c) { c.right.distortion[7] = kNan; }) == Fault::kRightCamera);
    CHECK(with([](C& c) { c.R = {}; }) == Fault::kRotation);
    CHECK(with([](C& c) { c.R[4] = kNan; }) == Fault::kRotation);
    CHECK(with([](C& c) { c.R = test::turn_of(0.0, 0.9, 0.0); }) == Fault::kRotation);
    CHECK(with([](C& c) { c.R = {1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, -1.0}; }) == Fault::kRotation);
    CHECK(with([](C& c) { c.T_m = {}; }) == Fault::kBaseline);
    CHECK(with([](C& c) { c.T_m[0] = -120.0; }) == Fault::kBaseline);
    CHECK(with([](C& c) { c.T_m[2] = kNan; }) == Fault::kBaseline);
    CHECK(with([](C& c) { c.T_m[0] = 0.12; }) == Fault::kNotToTheRight);
    CHECK(with([](C& c) { c.T_m = {-0.1, 0.2, 0.0}; }) == Fault::kNotToTheRight);
    CHECK(with([](C& c) { c.rectified = true; }) == Fault::kNotRectified);
    // A barrel that folds within the picture, and one that folds beyond it.
    CHECK(with([](C& c) { c.left.distortion[0] = -1.0; }) == Fault::kLeftCamera);
    CHECK(with([](C& c) { c.right.distortion[0] = -1.0; }) == Fault::kRightCamera);
    CHECK(with([](C& c) { c.left.distortion[0] = -0.5; }) == Fault::kNone);
    CHECK(with([](C& c) { c.left.distortion[5] = 50.0; }) == Fault::kLeftCamera);
    CHECK(with([](C& c) { c.left.distortion[0] = c.right.distortion[0] = 1000.0; }) == Fault::kNothingLeft);
}

TEST_CASE("rectifier: whatever a calibration that is taken says, pictures come out") {
    Rng rng(11);
    int made = 0;
    for (int i = 0; i < 200; ++i) {
        StereoCalibration c = straight_pair();
        c.rectified = false;
        for (CameraIntrinsics* camera : {&c.left, &c.right}) {
            camera->fx_px *= 1.0 + 5.0 * (1.0 + rng.symmetric()) * (1.0 + rng.symmetric());
            camera->fy_px *= 1.0 + 5.0 * (1.0 + rng.symmetric()) * (1.0 + rng.symmetric());
            camera->cx_px += 100.0 * rng.symmetric() * rng.symmetric();
            for (double& k : camera->distortion) {
                const double u = rng.symmetric();
                k = 10.0 * u * u * u * u * u;
            }
        }
        c.R = test::turn_of(0.4 * rng.symmetric(), 0.4 * rng.symmetric(), 0.3 * rng.symmetric());
        c.T_m = {-0.1, 0.09 * rng.symmetric(), 0.09 * rng.symmetric()};
        CalibrationFault fault = CalibrationFault::kNone;
        auto rectifier = StereoRectifier::make(c, fault);
        if (!rectifier) {
            continue;
        }
        ++made;
        const GrayImage picture(32, 24);
        const StereoView out = rectifier->rectify({.left = picture.view(), .right = picture.view()});
        CHECK(out.left.width == 32);
        CHECK(std::isfinite(rectifier->camera().focal_px));
        CHECK(rectifier->camera().baseline_m > 0.0);
    }
    CHECK(made > 20);
    CHECK(made < 200);
}
