#include <catch2/catch.hpp>
#include <string>
#include <vector>

#include "platform/files/input_error.hpp"
#include "tests/unit/sim/recorder.hpp"
#include "tools/sim/stereo_rig.hpp"

namespace crspf {

namespace {

/// Keeps what a camera saw.
class Album final : public sim::LogWriter {
 public:
    void odometry(const sim::OdometryRecord& /*record*/, std::string& /*out*/) override {}
    void scan(const sim::ScanRecord& /*record*/, std::string& /*out*/) override {}
    void pictures(const sim::PictureRecord& record, std::string& /*out*/) override { records.push_back(record); }

    std::vector<sim::PictureRecord> records;
};

double mean(const GrayImage& picture) {
    double sum = 0.0;
    for (const std::uint8_t value : picture.pixels) {
        sum += value;
    }
    return sum / static_cast<double>(picture.pixels.size());
}

sim::SimulationParams with_camera(double rate_hz) {
    sim::SimulationParams params = test::ideal();
    params.start_us = 7'000'000;
    params.duration_s = 3.0;
    params.stereo = sim::StereoRigParams{.camera = {.camera = sim::usual_camera(64, 48),
                                                    .mounting = {.x_m = 0.1, .y_m = 0.06, .z_m = 0.8, .yaw_rad = 0.2}},
                                         .rate_hz = rate_hz,
                                         .blind = {}};
    return params;
}

}  // namespace

TEST_CASE("stereo rig: pairs come at their rate, from where the camera truly is at that instant") {
    Album album;
    const sim::SimulationResult result = test::run(test::room(12.0, 8.0), with_camera(10.0), album);
    CHECK(album.records.size() >= 29);
    REQUIRE(album.records.size() <= result.truth.size() + 1);
    for (std::size_t i = 0; i + 1 < album.records.size(); ++i) {
        CAPTURE(i);
        const sim::PictureRecord& record = album.records[i];
        CHECK(record.stamp_us == 7'000'000 + 100'000 * static_cast<std::int64_t>(i));
        // The lidar's first beams are measured at the same times.
        const Pose2 expected = result.truth.at(i).P_map_base * Pose2{.x_m = 0.1, .y_m = 0.06, .theta_rad = 0.2};
        CHECK(record.P_world_left.x_m == Approx(expected.x_m).margin(1e-9));
        CHECK(record.P_world_left.y_m == Approx(expected.y_m).margin(1e-9));
        CHECK(record.P_world_left.theta_rad == Approx(expected.theta_rad).margin(1e-9));
        CHECK(record.pictures.right.width == 64);
        CHECK(record.pictures.right.height == 48);
    }
    const Pose2 way = inverse(album.records.front().P_world_left) * album.records.back().P_world_left;
    CHECK(way.x_m * way.x_m + way.y_m * way.y_m > 0.25);
}

TEST_CASE("stereo rig: blind within its spells only") {
    sim::SimulationParams params = with_camera(20.0);
    params.stereo->blind = {{.from_s = 0.5, .to_s = 1.0}, {.from_s = 1.2, .to_s = 1.3, .kind = sim::Blindness::kBare}};
    Album album;
    test::run(test::room(12.0, 8.0), params, album);
    for (const sim::PictureRecord& record : album.records) {
        const double now_s = static_cast<double>(record.stamp_us - params.start_us) * 1e-6;
        CAPTURE(now_s);
        CHECK((mean(record.pictures.left) < 10.0) == (now_s > 0.49 && now_s < 0.99));
        CHECK((mean(record.pictures.right) == Approx(150.0).margin(0.3)) == (now_s > 1.19 && now_s < 1.29));
    }
}

TEST_CASE("stereo rig: not beside a lidar that sees uneven ground") {
    sim::SimulationParams params = with_camera(10.0);
    params.lidar = sim::lidar_model("velodyne");
    Album album;
    CHECK_THROWS_AS(test::run(test::room(12.0, 8.0), params, album), InputError);
}

}  // namespace crspf
