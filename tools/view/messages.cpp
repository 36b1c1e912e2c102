#include "tools/view/messages.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <utility>

#include "core/base/trig.hpp"
#include "platform/files/base64.hpp"

namespace crspf::view {
namespace {

// foxglove.NumericType.
constexpr int kUint8 = 1;
constexpr int kFloat32 = 7;

Json vector_of(double x, double y) {
    return {{"x", x}, {"y", y}, {"z", 0.0}};
}

Json quaternion_of(double yaw_rad) {
    const SinCos half = sin_cos(0.5 * yaw_rad);
    return {{"x", 0.0}, {"y", 0.0}, {"z", half.sin}, {"w", half.cos}};
}

Json transform(std::int64_t stamp_ns, const char* parent, const char* child, const Pose2& pose) {
    return {{"timestamp", time_of(stamp_ns)},
            {"parent_frame_id", parent},
            {"child_frame_id", child},
            {"translation", vector_of(pose.x_m, pose.y_m)},
            {"rotation", quaternion_of(pose.theta_rad)}};
}

Json field(const char* name, std::uint32_t offset, int type) {
    return {{"name", name}, {"offset", offset}, {"type", type}};
}

void append_little_endian(std::vector<std::uint8_t>& bytes, float value) {
    const auto bits = std::bit_cast<std::uint32_t>(value);
    for (const unsigned shift : {0U, 8U, 16U, 24U}) {
        bytes.push_back(static_cast<std::uint8_t>(bits >> shift));
    }
}

/// Few digits: a path has thousands of poses.
double rounded(double value) {
    constexpr double kSteps = 1e4;
    return std::round(value * kSteps) / kSteps;
}

}  // namespace

std::shared_ptr<const Message> message_of(std::int64_t stamp_ns, const Json& data) {
    return std::make_shared<const Message>(
        Message{.stamp_ns = stamp_ns, .data = data.dump(-1, ' ', false, Json::error_handler_t::replace)});
}

Json time_of(std::int64_t stamp_ns) {
    constexpr std::int64_t kSecond_ns = 1'000'000'000;
    const std::int64_t ns = std::max<std::int64_t>(stamp_ns, 0);
    return {{"sec", ns / kSecond_ns}, {"nsec", ns % kSecond_ns}};
}

Json pose_of(const Pose2& pose) {
    return {{"position", vector_of(pose.x_m, pose.y_m)}, {"orientation", quaternion_of(pose.theta_rad)}};
}

Json tf_message(const ScanEvent& scan) {
    const Pose2 P_odom_base = inverse(scan.P_map_odom) * scan.P_map_base;
    return {{"transforms", Json::array({transform(scan.stamp_ns, "map", "odom", scan.P_map_odom),
                                        transform(scan.stamp_ns, "odom", "base_link", P_odom_base)})}};
}

Json pose_message(const ScanEvent& scan) {
    return {{"timestamp", time_of(scan.stamp_ns)}, {"frame_id", "map"}, {"pose", pose_of(scan.P_map_base)}};
}

Json scan_message(const ScanEvent& scan) {
    constexpr std::uint32_t kStride = 9;
    std::vector<std::uint8_t> bytes;
    bytes.reserve(kStride * scan.points.size());
    for (const ScanEvent::Point& point : scan.points) {
        append_little_endian(bytes, point.x_m);
        append_little_endian(bytes, point.y_m);
        bytes.push_back(point.critical ? 1 : 0);
    }
    return {{"timestamp", time_of(scan.stamp_ns)},
            {"frame_id", "base_link"},
            {"pose", pose_of({})},
            {"point_stride", kStride},
            {"fields", Json::array({field("x", 0, kFloat32), field("y", 4, kFloat32), field("critical", 8, kUint8)})},
            {"data", to_base64(bytes)}};
}

Json match_message(const ScanEvent& scan) {
    const Covariance3& c = scan.covariance;
    const AnalyserParams& t = scan.thresholds;
    return {
        {"timestamp", time_of(scan.stamp_ns)},
        {"x_m", scan.P_map_base.x_m},
        {"y_m", scan.P_map_base.y_m},
        {"heading_rad", scan.P_map_base.theta_rad},
        {"covariance", {c.xx, c.xy, c.yy, c.xt, c.yt, c.tt}},
        {"M", scan.M},
        {"m", scan.m},
        {"thresholds",
         {{"result_on", t.result_on}, {"result_off", t.result_off}, {"draw_on", t.draw_on}, {"draw_off", t.draw_off}}},
        {"matched", scan.matched},
        {"result", scan.result},
        {"draw", scan.draw},
        {"lost", scan.lost},
        {"degenerate", scan.degenerate},
        {"rays", scan.rays},
        {"critical_rays", scan.critical_rays},
        {"evaluations", scan.evaluations},
        {"range_m", scan.range_m},
        {"range_rad", scan.range_rad}};
}

Json path_message(std::int64_t stamp_ns, const std::vector<Pose2>& path) {
    Json poses = Json::array();
    for (const Pose2& pose : path) {
        const SinCos half = sin_cos(0.5 * pose.theta_rad);
        poses.push_back(
            {{"position", vector_of(rounded(pose.x_m), rounded(pose.y_m))},
             {"orientation", {{"x", 0.0}, {"y", 0.0}, {"z", rounded(half.sin)}, {"w", rounded(half.cos)}}}});
    }
    return {{"timestamp", time_of(stamp_ns)}, {"frame_id", "map"}, {"poses", std::move(poses)}};
}

Json status_message(const StatusEvent& status) {
    Json message{{"timestamp", time_of(status.stamp_ns)}};
    if (status.status.is_object()) {
        message.update(status.status);
    }
    return message;
}

Json log_message(const LogLine& line) {
    return {{"timestamp", time_of(line.stamp_ns)},
            {"level", static_cast<int>(line.level)},
            {"message", line.text},
            {"name", "crspf"},
            {"file", ""},
            {"line", 0}};
}

Json map_message(std::int64_t stamp_ns, const GridPicture& picture) {
    constexpr double kBelow_m = 0.01;  // so that path and scan, which are drawn in the same plane, are seen upon it
    Json corner = pose_of(picture.P_map_corner);
    corner["position"]["z"] = -kBelow_m;
    return {{"timestamp", time_of(stamp_ns)},
            {"frame_id", "map"},
            {"pose", std::move(corner)},
            {"column_count", picture.columns},
            {"cell_size", {{"x", picture.cell_m}, {"y", picture.cell_m}}},
            {"row_stride", picture.columns},
            {"cell_stride", 1},
            {"fields", Json::array({field("taken", 0, kUint8)})},
            {"data", to_base64(picture.cells)}};
}

}  // namespace crspf::view
