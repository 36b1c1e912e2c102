// What the pictures show must be where an independent projection puts it.
#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <cstdlib>
#include <string>
#include <vector>

#include "core/base/trig.hpp"
#include "platform/files/input_error.hpp"
#include "tests/unit/sim/recorder.hpp"
#include "tools/sim/stereo_camera.hpp"

namespace crspf {

namespace {

using sim::Blindness;
using sim::StereoCamera;
using sim::StereoPictures;

constexpr int kWidth = 640;
constexpr int kHeight = 360;
constexpr double kFocal_px = 320.0;
constexpr double kBaseline_m = 0.12;
constexpr int kMiddle = 180;  // the row that looks half a pixel below the horizon

sim::StereoCameraParams plain() {
    return {.camera = sim::usual_camera(kWidth, kHeight), .mounting = {.z_m = 1.0}, .grain = false, .noise = 0.0};
}

sim::StereoCameraParams grained() {
    sim::StereoCameraParams params = plain();
    params.grain = true;
    return params;
}

double pixel(const GrayImage& picture, int x, int y) {
    return picture.pixels[static_cast<std::size_t>(y) * kWidth + static_cast<std::size_t>(x)];
}

/// Where, between two pixels of a row, one brightness turns into another: to the share in which both fill a pixel.
double edge_in_row(const GrayImage& picture, int y, int from, int to) {
    const double before = pixel(picture, from, y);
    const double behind = pixel(picture, to, y);
    double share = 0.0;
    for (int x = from; x <= to; ++x) {
        share += (pixel(picture, x, y) - behind) / (before - behind);
    }
    return from - 0.5 + share;
}

double edge_in_column(const GrayImage& picture, int x, int from, int to) {
    const double before = pixel(picture, x, from);
    const double behind = pixel(picture, x, to);
    double share = 0.0;
    for (int y = from; y <= to; ++y) {
        share += (pixel(picture, x, y) - behind) / (before - behind);
    }
    return from - 0.5 + share;
}

/// Of a point of the world, in the picture of an eye that looks along its x.
double column_of(const Pose2& P_world_eye, sim::Point p) {
    const Pose2 at = inverse(P_world_eye) * Pose2{.x_m = p.x_m, .y_m = p.y_m, .theta_rad = 0.0};
    return (kWidth - 1) / 2.0 - kFocal_px * at.y_m / at.x_m;
}

double deviation(const GrayImage& a, const GrayImage& b) {
    double squares = 0.0;
    for (std::size_t i = 0; i < a.pixels.size(); ++i) {
        const double difference = static_cast<double>(a.pixels[i]) - static_cast<double>(b.pixels[i]);
        squares += difference * difference;
    }
    return std::sqrt(squares / static_cast<double>(a.pixels.size()));
}

/// Root mean square of what neighbours differ by, to the side and downwards.
double contrast(const GrayImage& picture, int dx, int dy) {
    double squares = 0.0;
    for (int y = 0; y < kHeight - 1; ++y) {
        for (int x = 0; x < kWidth - 1; ++x) {
            const double difference = pixel(picture, x + dx, y + dy) - pixel(picture, x, y);
            squares += difference * difference;
        }
    }
    return std::sqrt(squares / ((kWidth - 1) * (kHeight - 1)));
}

}  // namespace

TEST_CASE("stereo camera: a wall meets floor and ceiling where perspective says") {
    const sim::Scene scene = test::room(12.0, 8.0);
    StereoCamera camera(scene, plain(), 1);
    const double turn_rad = 0.15;
    const StereoPictures seen = camera.shoot({.x_m = 2.0, .y_m = 3.5, .theta_rad = turn_rad}, {});
    for (const int x : {240, 320, 420}) {
        CAPTURE(x);
        // Ahead of the eye until its column of pixels meets the wall at x = 12.
        const double aside = ((kWidth - 1) / 2.0 - x) / kFocal_px;
        const SinCos heading = sin_cos(turn_rad);
        const double ahead_m = 10.0 / (heading.cos - aside * heading.sin);
        const double horizon = (kHeight - 1) / 2.0;
        CHECK(edge_in_column(seen.left, x, 190, 240) == Approx(horizon + kFocal_px * 1.0 / ahead_m).margin(0.1));
        CHECK(edge_in_column(seen.left, x, 110, 170) == Approx(horizon - kFocal_px * 1.5 / ahead_m).margin(0.1));
    }
}

TEST_CASE("stereo camera: an edge lies at its own place in each picture, and apart by focal length x base / distance") {
    const sim::Scene scene = test::room(30.0, 20.0);
    sim::StereoCameraParams params = plain();
    params.mounting = {.x_m = 0.3, .y_m = 0.1, .z_m = 1.0, .yaw_rad = 0.2};
    StereoCamera camera(scene, params, 1);
    const Pose2 P_world_base{.x_m = 2.0, .y_m = 10.0, .theta_rad = -0.1};
    const Pose2 P_world_left = P_world_base * Pose2{.x_m = 0.3, .y_m = 0.1, .theta_rad = 0.2};
    const Pose2 P_world_right = P_world_left * Pose2{.x_m = 0.0, .y_m = -kBaseline_m, .theta_rad = 0.0};
    for (const double ahead_m : {2.7, 4.4, 9.3}) {
        CAPTURE(ahead_m);
        // The nearer left corner of a car that stands as the camera looks.
        const Pose2 corner = P_world_left * Pose2{.x_m = ahead_m, .y_m = 0.2, .theta_rad = 0.0};
        const Pose2 centre = P_world_left * Pose2{.x_m = ahead_m + 2.0, .y_m = 0.2 - 0.9, .theta_rad = 0.0};
        const std::vector<sim::Box> cars{{.centre = {centre.x_m, centre.y_m},
                                          .heading = sin_cos(centre.theta_rad),
                                          .half_length_m = 2.0,
                                          .half_width_m = 0.9,
                                          .height_m = 1.5}};
        const StereoPictures seen = camera.shoot(P_world_base, {.cars = cars});
        const auto edge = [&](const GrayImage& picture, const Pose2& P_world_eye) {
            const double expected = column_of(P_world_eye, {corner.x_m, corner.y_m});
            const int near = static_cast<int>(std::lround(expected));
            const double found = edge_in_row(picture, kMiddle, near - 4, near + 4);
            CHECK(found == Approx(expected).margin(0.1));
            return found;
        };
        const double disparity = edge(seen.left, P_world_left) - edge(seen.right, P_world_right);
        CHECK(disparity == Approx(kFocal_px * kBaseline_m / ahead_m).margin(0.1));
    }
}

TEST_CASE("stereo camera: a wall's grain is on the wall, for both eyes and from wherever it is seen") {
    const sim::Scene scene = test::room(3.84 + 1.0, 40.0);
    StereoCamera camera(scene, grained(), 1);
    const Pose2 here{.x_m = 1.0, .y_m = 20.0, .theta_rad = 0.0};
    const StereoPictures seen = camera.shoot(here, {});
    const StereoPictures from_beside = camera.shoot(here * Pose2{.x_m = 0.0, .y_m = -0.24, .theta_rad = 0.0}, {});
    CHECK(contrast(seen.left, 1, 0) > 4.0);
    constexpr int kDisparity = 10;  // 320 px x 0.12 m / 3.84 m
    double worst = 0.0;
    for (int y = 120; y < 240; ++y) {
        for (int x = 40; x < kWidth; ++x) {
            worst = std::max({worst, std::abs(pixel(seen.left, x, y) - pixel(seen.right, x - kDisparity, y)),
                              std::abs(pixel(seen.left, x, y) - pixel(from_beside.left, x - 2 * kDisparity, y))});
        }
    }
    CHECK(worst <= 1.0);
}

TEST_CASE("stereo camera: what moves takes its grain along") {
    const sim::Scene scene = test::room(40.0, 20.0);
    StereoCamera camera(scene, grained(), 1);
    const auto shot = [&](double x_m, double y_m) {
        const std::vector<sim::Box> cars{
            {.centre = {x_m + 6.0, y_m}, .half_length_m = 2.0, .half_width_m = 0.9, .height_m = 1.5}};
        const std::vector<sim::Circle> legs{{{x_m + 3.0, y_m + 1.5}, 0.1}};
        return camera.shoot({.x_m = x_m, .y_m = y_m, .theta_rad = 0.0}, {.legs = legs, .cars = cars});
    };
    const StereoPictures before = shot(2.0, 10.0);
    const StereoPictures after = shot(5.2, 9.1);
    double worst = 0.0;
    double wall = 0.0;
    for (int y = 150; y < 200; ++y) {
        for (int x = 260; x < 380; ++x) {  // the car: 0.9 m to either side, 4 m ahead
            worst = std::max(worst, std::abs(pixel(before.left, x, y) - pixel(after.left, x, y)));
        }
        for (int x = 155; x < 164; ++x) {  // the leg
            worst = std::max(worst, std::abs(pixel(before.left, x, y) - pixel(after.left, x, y)));
        }
        for (int x = 450; x < 600; ++x) {
            wall = std::max(wall, std::abs(pixel(before.left, x, y) - pixel(after.left, x, y)));
        }
    }
    CHECK(worst <= 1.0);
    CHECK(wall > 10.0);
}

TEST_CASE("stereo camera: noise has its size, and differs from shot to shot but not from run to run") {
    const sim::Scene scene = test::room(12.0, 8.0);
    sim::StereoCameraParams params = plain();
    params.noise = 1.5;
    const Pose2 here{.x_m = 2.0, .y_m = 3.5, .theta_rad = 0.0};
    StereoCamera camera(scene, params, 1);
    const StereoPictures first = camera.shoot(here, {});
    const StereoPictures second = camera.shoot(here, {});
    // Twice the variance of one, and of its rounding.
    CHECK(deviation(first.left, second.left) == Approx(std::sqrt(2.0 * (1.5 * 1.5 + 1.0 / 12.0))).epsilon(0.02));
    StereoCamera again(scene, params, 1);
    CHECK(again.shoot(here, {}).left.pixels == first.left.pixels);
    CHECK(again.shoot(here, {}).right.pixels == second.right.pixels);
    StereoCamera other(scene, params, 2);
    CHECK(other.shoot(here, {}).left.pixels != first.left.pixels);
}

TEST_CASE("stereo camera: blind in the dark, when moved, before a bare wall") {
    const sim::Scene scene = sim::make_scene("hall");
    sim::StereoCameraParams params = grained();
    params.noise = 1.5;
    StereoCamera camera(scene, params, 1);
    const Pose2 here{.x_m = 3.0, .y_m = 12.0, .theta_rad = 0.3};
    const GrayImage clear = camera.shoot(here, {}).left;
    const GrayImage dark = camera.shoot(here, {}, Blindness::kDark).left;
    const GrayImage blurred = camera.shoot(here, {}, Blindness::kBlur).left;
    const GrayImage bare = camera.shoot(here, {}, Blindness::kBare).left;
    CHECK(contrast(clear, 1, 0) > 4.0);
    CHECK(contrast(clear, 0, 1) > 4.0);
    CHECK(*std::max_element(dark.pixels.begin(), dark.pixels.end()) < 12);
    CHECK(contrast(blurred, 1, 0) < 0.5 * contrast(clear, 1, 0));
    CHECK(contrast(bare, 1, 0) == Approx(std::sqrt(2.0 * (1.5 * 1.5 + 1.0 / 12.0))).epsilon(0.02));
}

TEST_CASE("stereo camera: one that does not stand upright between ground and ceiling is refused") {
    const sim::Scene scene = test::room(12.0, 8.0);
    const auto refused = [&](const CameraMounting& mounting, const std::string& key) {
        sim::StereoCameraParams params = plain();
        params.mounting = mounting;
        CHECK_THROWS_WITH(StereoCamera(scene, params, 1), Catch::Contains(key));
    };
    refused({.roll_rad = 0.1}, "roll_deg");
    refused({.pitch_rad = -0.1}, "pitch_deg");
    refused({.z_m = 0.0}, "z_m");
    refused({.z_m = 2.5}, "z_m");
}

}  // namespace crspf
