// `crspf sim` with a stereo camera, as a user calls it: the folder of pictures, the capture, and what is refused.
#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <memory>
#include <sstream>
#include <string>
#include <vector>

#include "config/config.hpp"
#include "platform/capture/capture_reader.hpp"
#include "platform/capture/stereo_record.hpp"
#include "platform/files/gray_png.hpp"
#include "platform/files/input_error.hpp"
#include "platform/files/trajectory.hpp"
#include "platform/service/stereo_calibration.hpp"
#include "tests/unit/sim/command.hpp"
#include "tools/sim/capture_writer.hpp"
#include "tools/sim/kitti_folder.hpp"

namespace crspf {

namespace {

namespace fs = std::filesystem;
using test::content;
using test::crspf_sim;
using test::TemporaryFolder;

/// The sick_stereo profile with pictures of 128 x 96, to be quick.
fs::path small_profile(const TemporaryFolder& folder, const std::string& more = "") {
    std::string text = content(std::string(CRSPF_SOURCE_DIR) + "/config/examples/sick_stereo.toml");
    const auto replace = [&](const std::string& from, const std::string& to) {
        REQUIRE(text.find(from) != std::string::npos);
        text.replace(text.find(from), from.size(), to);
    };
    replace("width_px = 640", "width_px = 128");
    replace("height_px = 360", "height_px = 96");
    fs::path file = folder / "robot.toml";
    std::ofstream(file) << text << more;
    return file;
}

GrayImage picture_of(const fs::path& file) {
    const std::string bytes = content(file);
    return decode_gray_png(std::vector<std::uint8_t>(bytes.begin(), bytes.end()), file.string());
}

std::vector<std::vector<double>> rows_of(const fs::path& file) {
    std::istringstream lines(content(file));
    std::vector<std::vector<double>> rows;
    for (std::string line; std::getline(lines, line);) {
        std::istringstream fields(line);
        rows.emplace_back();
        for (double value = 0.0; fields >> value;) {
            rows.back().push_back(value);
        }
    }
    return rows;
}

}  // namespace

TEST_CASE("crspf sim --stereo: a folder that reads back") {
    const TemporaryFolder folder;
    const fs::path pictures = folder / "pictures";
    crspf_sim({"--duration", "0.18", "--out", (folder / "run").string(), "--stereo", pictures.string()});
    const auto times = rows_of(pictures / "times.txt");
    REQUIRE(times.size() == 3);
    CHECK(times[0].at(0) == 0.0);
    CHECK(times[2].at(0) == Approx(2.0 / 15.0).margin(1e-6));
    for (const char* name : {"image_0/000000.png", "image_1/000002.png"}) {
        const GrayImage picture = picture_of(pictures / name);
        CHECK(picture.width == 640);
        CHECK(picture.height == 360);
        const auto [darkest, brightest] = std::minmax_element(picture.pixels.begin(), picture.pixels.end());
        CHECK(*brightest - *darkest > 50);
    }
    CHECK(picture_of(pictures / "image_0/000001.png").pixels != picture_of(pictures / "image_1/000001.png").pixels);
    CHECK_FALSE(fs::exists(pictures / "image_0/000003.png"));

    const StereoCalibration camera = read_stereo_calibration(pictures / "calib.txt");
    CHECK(camera.rectified);
    CHECK(camera.left.fx_px == 320.0);
    CHECK(camera.left.cx_px == 319.5);
    CHECK(camera.left.cy_px == 179.5);
    CHECK(camera.T_m[0] == Approx(-0.12));
    const Config config = load_config(folder / "run/config.toml");
    CHECK(content(pictures / "calib.txt") == config.stereo.calibration_text);
    CHECK(config.stereo.height_px == 360);

    // A shorter run leaves nothing of the longer one.
    crspf_sim({"--duration", "0.1", "--out", (folder / "run").string(), "--stereo", pictures.string()});
    CHECK(rows_of(pictures / "times.txt").size() == 2);
    CHECK(fs::exists(pictures / "image_1/000001.png"));
    CHECK_FALSE(fs::exists(pictures / "image_1/000002.png"));
}

TEST_CASE("pictures in a folder: poses are those of the left camera in its own axes, from the first on") {
    const TemporaryFolder folder;
    sim::KittiFolder writer(folder / "pictures", sim::usual_camera(8, 4));
    const Pose2 first{.x_m = 3.0, .y_m = 4.0, .theta_rad = 0.5};
    const Pose2 later = first * Pose2{.x_m = 2.0, .y_m = 1.0, .theta_rad = 0.3};
    std::string out;
    for (const Pose2& pose : {first, later}) {
        writer.pictures({.stamp_us = 0, .P_world_left = pose, .pictures = {GrayImage(8, 4), GrayImage(8, 4)}}, out);
    }
    writer.finish();
    const auto poses = rows_of(folder / "pictures/poses.txt");
    REQUIRE(poses.size() == 2);
    const std::vector<double> identity{1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0};
    REQUIRE(poses[0].size() == 12);
    for (std::size_t i = 0; i < 12; ++i) {
        CHECK(poses[0][i] == Approx(identity[i]).margin(1e-12));
    }
    // A point 1 m to the right of the second camera, 5 m ahead and 2 m below, seen from the first.
    const Pose2 seen = inverse(first) * later * Pose2{.x_m = 5.0, .y_m = -1.0, .theta_rad = 0.0};
    const std::vector<double>& P = poses[1];
    CHECK(P.at(0) * 1.0 + P.at(1) * 2.0 + P.at(2) * 5.0 + P.at(3) == Approx(-seen.y_m));
    CHECK(P.at(4) * 1.0 + P.at(5) * 2.0 + P.at(6) * 5.0 + P.at(7) == Approx(2.0));
    CHECK(P.at(8) * 1.0 + P.at(9) * 2.0 + P.at(10) * 5.0 + P.at(11) == Approx(seen.x_m));
}

TEST_CASE("crspf sim --stereo: the same pictures for the same seed, plain or with grain, and blind when told") {
    const TemporaryFolder folder;
    const auto run = [&](const char* name, const std::vector<std::string>& more) {
        std::vector<std::string> arguments{
            "--duration", "0.18", "--out", (folder / "run").string(), "--stereo", (folder / name).string()};
        arguments.insert(arguments.end(), more.begin(), more.end());
        crspf_sim(arguments);
        return content(folder / name / "image_0/000001.png");
    };
    const std::string first = run("a", {"--seed", "5"});
    CHECK(first == run("b", {"--seed", "5"}));
    CHECK(content(folder / "a/image_1/000002.png") == content(folder / "b/image_1/000002.png"));
    CHECK(first != run("c", {"--seed", "6"}));
    CHECK(first != run("d", {"--seed", "5", "--plain"}));
    CHECK(first != run("e", {"--seed", "5", "--blind", "0.05:0.1:blur"}));
    CHECK(content(folder / "a/image_0/000000.png") == content(folder / "e/image_0/000000.png"));
    CHECK(content(folder / "a/image_0/000002.png") == content(folder / "e/image_0/000002.png"));
}

TEST_CASE("crspf sim --config: a stereo camera as the only odometer, in the capture") {
    const TemporaryFolder folder;
    const fs::path file = folder / "run.pcapng";
    const fs::path pictures = folder / "pictures";
    crspf_sim({"--config", small_profile(folder).string(), "--robot", "car", "--world", "campus", "--cars", "3",
               "--duration", "0.98", "--capture", file.string(), "--stereo", pictures.string()});
    const std::unique_ptr<CaptureReader> reader = open_capture(file);
    CaptureRecord record;
    std::vector<Stamp> stamps;
    Stamp lidar;
    while (reader->next(record)) {
        if (record.link != LinkKind::kStereo) {
            lidar = record.stamp;
            continue;
        }
        // It comes when all of it has been transferred.
        CHECK((lidar - record.stamp).seconds() == Approx(0.03).margin(0.03));
        if (stamps.size() == 3) {
            const auto pair = split_stereo_record(record.bytes);
            REQUIRE(pair);
            CHECK(decode_gray_png(pair->left_png, "left").pixels == picture_of(pictures / "image_0/000003.png").pixels);
            CHECK(decode_gray_png(pair->right_png, "right").pixels ==
                  picture_of(pictures / "image_1/000003.png").pixels);
        }
        stamps.push_back(record.stamp);
    }
    REQUIRE(reader->sources().size() == 2);
    CHECK(reader->sources()[0].name == "front");
    CHECK(reader->sources()[1].name == sim::kStereoSource);
    CHECK(reader->sources()[1].link == LinkKind::kStereo);
    const auto times = rows_of(pictures / "times.txt");
    REQUIRE(stamps.size() == 15);
    REQUIRE(times.size() == stamps.size());
    for (std::size_t i = 0; i < stamps.size(); ++i) {
        CHECK((stamps[i] - Stamp{}).seconds() == Approx(times[i].at(0)).epsilon(0.0).margin(1e-5));
    }
    CHECK(times[0].at(0) == Approx(1767225600.5).epsilon(0.0).margin(1e-5));

    const Config carried = parse_config(reader->comment(), file.string());
    CHECK(parse_stereo_calibration(carried.stereo.calibration_text, "carried").left.fx_px == 64.0);
    CHECK(carried.stereo.odometry.mounting.z_m == 1.2);
}

TEST_CASE("crspf sim --config: the camera is that of the calibration file") {
    const TemporaryFolder folder;
    const fs::path calibration = folder / "own.txt";
    const RectifiedCamera own{
        .width = 128, .height = 96, .focal_px = 90.5, .cx_px = 60.25, .cy_px = 50.0, .baseline_m = 0.2};
    const auto run = [&](const std::string& text) {
        std::ofstream(calibration) << text;
        crspf_sim({"--config", small_profile(folder, "calibration = \"own.txt\"\n").string(), "--robot", "car",
                   "--world", "campus", "--duration", "0.1", "--capture", (folder / "run.pcapng").string()});
    };
    run(sim::kitti_calibration(own));
    const auto reader = open_capture(folder / "run.pcapng");
    CaptureRecord record;
    REQUIRE(reader->next(record));
    CHECK(parse_config(reader->comment(), "carried").stereo.calibration_text == sim::kitti_calibration(own));

    CHECK_THROWS_WITH(run("P0: 1 2 3\n"), Catch::Contains("own.txt"));
    RectifiedCamera mirrored = own;
    mirrored.baseline_m = -0.2;
    CHECK_THROWS_WITH(run(sim::kitti_calibration(mirrored)), Catch::Contains("to the right"));
}

TEST_CASE("crspf sim --stereo refuses what no camera could do") {
    const TemporaryFolder folder;
    const std::string out = (folder / "run").string();
    const std::string pictures = (folder / "pictures").string();
    for (const char* spell : {"5", "5:4", "-1:4", "a:b", "1:2:fog", "1:2:dark:3"}) {
        CAPTURE(spell);
        CHECK_THROWS_WITH(crspf_sim({"--out", out, "--stereo", pictures, "--blind", spell}),
                          Catch::Contains("--blind"));
    }
    CHECK_THROWS_WITH(crspf_sim({"--out", out, "--blind", "1:2"}), Catch::Contains("--stereo"));
    CHECK_THROWS_WITH(
        crspf_sim({"--lidar", "velodyne", "--capture", (folder / "run.pcapng").string(), "--stereo", pictures}),
        Catch::Contains("level ground"));
    CHECK_THROWS_WITH(crspf_sim({"--config", small_profile(folder, "pitch_deg = 3.0\n").string(), "--robot", "car",
                                 "--world", "campus", "--capture", (folder / "run.pcapng").string()}),
                      Catch::Contains("upright"));
    CHECK_THROWS_AS(crspf_sim({"--out", out, "--stereo", "/dev/null/pictures"}), InputError);
}

}  // namespace crspf
