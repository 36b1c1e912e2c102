#include "platform/files/trajectory.hpp"

#include <array>
#include <charconv>
#include <cmath>
#include <string>
#include <string_view>

#include "core/base/trig.hpp"
#include "platform/files/atomic_file.hpp"
#include "platform/files/fields.hpp"
#include "platform/files/input_error.hpp"
#include "platform/files/read_file.hpp"

namespace crspf {
namespace {

constexpr std::size_t kFileBytesMax = std::size_t{1} << 30U;  // 24 h at 100 Hz
constexpr double kUnitTolerance = 0.01;                       // of a quaternion's length, as printed with few digits

bool parse_pose(std::string_view line, TimedPose& pose) {
    Fields fields(line);
    double z_m = 0.0;
    double qx = 0.0;
    double qy = 0.0;
    double qz = 0.0;
    double qw = 0.0;
    if (!fields.numbers(pose.stamp_s, pose.P_map_base.x_m, pose.P_map_base.y_m, z_m, qx, qy, qz, qw) ||
        !fields.at_end()) {
        return false;
    }
    const double length = std::sqrt(qx * qx + qy * qy + qz * qz + qw * qw);
    pose.P_map_base.theta_rad = wrap_angle(arc_tan2(2.0 * (qw * qz + qx * qy), 1.0 - 2.0 * (qy * qy + qz * qz)));
    return std::isfinite(pose.stamp_s) && std::isfinite(pose.P_map_base.x_m) && std::isfinite(pose.P_map_base.y_m) &&
           std::abs(length - 1.0) < kUnitTolerance;
}

void append_fixed(std::string& line, double value, int decimals) {
    std::array<char, 400> text{};  // the largest double has 309 digits before the point
    const auto [end, error] =
        std::to_chars(text.data(), text.data() + text.size(), value, std::chars_format::fixed, decimals);
    line.append(text.data(), end);
}

}  // namespace

std::vector<TimedPose> read_tum(const std::filesystem::path& file) {
    const std::string content = read_file(file, kFileBytesMax);
    std::vector<TimedPose> trajectory;
    std::string_view rest = content;
    for (std::size_t number = 1; !rest.empty(); ++number) {
        const std::size_t end = rest.find('\n');
        const std::string_view line = rest.substr(0, end);
        rest.remove_prefix(end == rest.npos ? rest.size() : end + 1);
        if (line.starts_with('#') || Fields(line).at_end()) {
            continue;
        }
        TimedPose pose;
        if (!parse_pose(line, pose)) {
            throw InputError(file.string() + ":" + std::to_string(number) +
                             ": not a pose in TUM format; a line reads `timestamp tx ty tz qx qy qz qw`, the "
                             "quaternion of length 1");
        }
        trajectory.push_back(pose);
    }
    return trajectory;
}

void write_tum(const std::vector<TimedPose>& trajectory, const std::filesystem::path& file) {
    AtomicFile out(file);
    std::string line;
    for (const TimedPose& pose : trajectory) {
        const SinCos half = sin_cos(0.5 * pose.P_map_base.theta_rad);
        line.clear();
        append_fixed(line, pose.stamp_s, 6);
        for (const double value : {pose.P_map_base.x_m, pose.P_map_base.y_m, 0.0, 0.0, 0.0, half.sin, half.cos}) {
            line += ' ';
            append_fixed(line, value, 9);
        }
        line += '\n';
        out.write(line);
    }
    out.commit();
}

}  // namespace crspf
