#include "tools/sim/kitti_folder.hpp"

#include <array>
#include <cstdio>
#include <fstream>
#include <string_view>
#include <system_error>
#include <utility>
#include <vector>

#include "core/base/trig.hpp"
#include "platform/files/atomic_file.hpp"
#include "platform/files/input_error.hpp"

namespace crspf::sim {
namespace {

namespace fs = std::filesystem;

constexpr std::array kPictures{"image_0", "image_1"};
constexpr std::array kTexts{"times.txt", "calib.txt", "poses.txt"};

void write_picture(const fs::path& file, const GrayImage& picture) {
    const std::vector<std::uint8_t> bytes = encode_gray_png(picture.view());
    // Not an AtomicFile, which waits for the disk each time: what tells that all is there is times.txt.
    std::ofstream out(file, std::ios::binary);
    // NOLINTNEXTLINE(cppcoreguidelines-pro-type-reinterpret-cast): bytes as the characters of a file
    out.write(reinterpret_cast<const char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
    if (!out.flush()) {
        throw InputError(file.string() + ": cannot be written; make room, or give another --stereo");
    }
}

std::string name_of(std::size_t pair) {
    char name[32];
    std::snprintf(name, sizeof name, "%06zu.png", pair);
    return name;
}

void write_text(const fs::path& file, std::string_view text) {
    AtomicFile out(file);
    out.write(text);
    out.commit();
}

std::string row(const std::array<double, 12>& matrix) {
    std::string text;
    for (const double value : matrix) {
        char number[40];
        std::snprintf(number, sizeof number, "%s%.12e", text.empty() ? "" : " ", value);
        text += number;
    }
    return text;
}

std::string projection(const RectifiedCamera& camera, double baseline_m) {
    return row({camera.focal_px, 0.0, camera.cx_px, -camera.focal_px * baseline_m, 0.0, camera.focal_px, camera.cy_px,
                0.0, 0.0, 0.0, 1.0, 0.0});
}

}  // namespace

std::string kitti_calibration(const RectifiedCamera& camera) {
    return "P0: " + projection(camera, 0.0) + "\nP1: " + projection(camera, camera.baseline_m) + "\n";
}

KittiFolder::KittiFolder(fs::path folder, const RectifiedCamera& camera) : folder_(std::move(folder)), camera_(camera) {
    std::error_code error;
    for (const char* name : kTexts) {
        fs::remove(folder_ / name, error);
    }
    for (const char* name : kPictures) {
        fs::create_directories(folder_ / name, error);
        if (error) {
            throw InputError((folder_ / name).string() + ": cannot be created: " + error.message() +
                             "; give another --stereo");
        }
    }
}

void KittiFolder::pictures(const PictureRecord& record, std::string& /*out*/) {
    const std::string name = name_of(pairs_++);
    write_picture(folder_ / kPictures[0] / name, record.pictures.left);
    write_picture(folder_ / kPictures[1] / name, record.pictures.right);
    char time[40];
    std::snprintf(time, sizeof time, "%.6f\n", static_cast<double>(record.stamp_us) * 1e-6);
    times_ += time;
    if (!P_world_first_) {
        P_world_first_ = record.P_world_left;
    }
    const Pose2 P_first_left = inverse(*P_world_first_) * record.P_world_left;
    const SinCos turn = sin_cos(P_first_left.theta_rad);
    // Forward is z, left is -x.
    poses_ += row({turn.cos, 0.0, -turn.sin, -P_first_left.y_m, 0.0, 1.0, 0.0, 0.0, turn.sin, 0.0, turn.cos,
                   P_first_left.x_m}) +
              "\n";
}

void KittiFolder::finish() {
    for (const char* side : kPictures) {
        std::error_code none;
        for (std::size_t pair = pairs_; fs::remove(folder_ / side / name_of(pair), none); ++pair) {
        }
    }
    write_text(folder_ / "calib.txt", kitti_calibration(camera_));
    write_text(folder_ / "poses.txt", poses_);
    write_text(folder_ / "times.txt", times_);
}

}  // namespace crspf::sim
