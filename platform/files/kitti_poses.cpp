#include "platform/files/kitti_poses.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <string>
#include <string_view>

#include "platform/files/atomic_file.hpp"
#include "platform/files/fields.hpp"
#include "platform/files/input_error.hpp"
#include "platform/files/read_file.hpp"

namespace crspf {

namespace {

constexpr std::size_t kFileBytesMax = std::size_t{1} << 30U;
constexpr double kTolerance = 0.01;  // of a rotation's axes, as printed with few digits

bool parse(std::string_view line, KittiPose& pose) {
    Fields fields(line);
    for (double& number : pose) {
        if (!fields.number(number) || !std::isfinite(number)) {
            return false;
        }
    }
    return fields.at_end();
}

bool is_rotation(const KittiPose& p) {
    const auto dot = [&](std::size_t a, std::size_t b) {
        return p.at(a) * p.at(b) + p.at(a + 4) * p.at(b + 4) + p.at(a + 8) * p.at(b + 8);
    };
    return std::abs(dot(0, 0) - 1.0) < kTolerance && std::abs(dot(1, 1) - 1.0) < kTolerance &&
           std::abs(dot(2, 2) - 1.0) < kTolerance && std::abs(dot(0, 1)) < kTolerance &&
           std::abs(dot(0, 2)) < kTolerance && std::abs(dot(1, 2)) < kTolerance;
}

/// visit(line, its number) until it is false.
template <class Visit>
void for_each_line(std::string_view content, Visit visit) {
    for (std::size_t number = 1; !content.empty(); ++number) {
        const std::size_t end = content.find('\n');
        const std::string_view line = content.substr(0, end);
        content.remove_prefix(end == content.npos ? content.size() : end + 1);
        if (!line.starts_with('#') && !Fields(line).at_end() && !visit(line, number)) {
            return;
        }
    }
}

}  // namespace

bool looks_like_kitti_poses(const std::filesystem::path& file) {
    bool twelve = false;
    for_each_line(read_file(file, kFileBytesMax), [&](std::string_view line, std::size_t) {
        KittiPose pose{};
        twelve = parse(line, pose);
        return false;
    });
    return twelve;
}

std::vector<KittiPose> read_kitti_poses(const std::filesystem::path& file) {
    std::vector<KittiPose> poses;
    for_each_line(read_file(file, kFileBytesMax), [&](std::string_view line, std::size_t number) {
        KittiPose pose{};
        if (!parse(line, pose) || !is_rotation(pose)) {
            throw InputError(file.string() + ":" + std::to_string(number) +
                             ": not a pose in KITTI's format; a line holds three rows of four numbers, a rotation and "
                             "the position");
        }
        poses.push_back(pose);
        return true;
    });
    return poses;
}

void write_kitti_poses(const std::vector<KittiPose>& poses, const std::filesystem::path& file) {
    AtomicFile out(file);
    std::string line;
    for (const KittiPose& pose : poses) {
        line.clear();
        for (const double number : pose) {
            std::array<char, 400> text{};
            std::snprintf(text.data(), text.size(), line.empty() ? "%.9f" : " %.9f", number);
            line += text.data();
        }
        out.write(line + "\n");
    }
    out.commit();
}

}  // namespace crspf
