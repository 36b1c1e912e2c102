#include "tools/mqtt/payloads.hpp"

#include <zlib.h>

#include <stdexcept>
#include <vector>

#include "core/base/trig.hpp"
#include "platform/files/base64.hpp"
#include "tools/view/status_parts.hpp"

namespace crspf::mqtt {
namespace {

constexpr double kDegrees = 180.0 / kPi;

std::vector<std::uint8_t> deflated(const TileImage& image) {
    std::vector<std::uint8_t> bytes(::compressBound(image.cells.size()));
    uLongf size = bytes.size();
    if (::compress(bytes.data(), &size, image.cells.data(), image.cells.size()) != Z_OK) {
        throw std::runtime_error("zlib does not compress a tile");
    }
    bytes.resize(size);
    return bytes;
}

const char* name_of(view::LogLine::Level level) {
    switch (level) {
        case view::LogLine::Level::kDebug: return "debug";
        case view::LogLine::Level::kInfo: return "info";
        case view::LogLine::Level::kWarning: return "warning";
        case view::LogLine::Level::kError: break;
    }
    return "error";
}

}  // namespace

Json pose_of_scan(const view::ScanEvent& scan) {
    const Pose2& P = scan.P_map_base;
    const Covariance3& c = scan.covariance;
    return {{"stamp_ns", scan.stamp_ns},
            {"x_m", P.x_m},
            {"y_m", P.y_m},
            {"heading_deg", kDegrees * wrap_angle(P.theta_rad)},
            {"covariance", {c.xx, c.xy, c.yy, c.xt, c.yt, c.tt}},
            {"M", scan.M},
            {"matched", scan.matched},
            {"result", scan.result},
            {"degenerate", scan.degenerate},
            {"lost", scan.lost}};
}

Json pose_of_status(const view::StatusEvent& status) {
    const Json& pose = view::part_of(status.status, "pose");
    if (!pose.is_object()) {
        return nullptr;
    }
    Json payload{{"stamp_ns", status.stamp_ns}};
    for (const char* name : {"x_m", "y_m", "heading_deg", "covariance", "M"}) {
        payload[name] = view::part_of(pose, name);
    }
    payload["matched"] = false;  // no scan is behind this moment's pose
    for (const char* name : {"result", "degenerate", "lost"}) {
        payload[name] = view::part_of(pose, name);
    }
    return payload;
}

Json log_payload(const view::LogLine& line) {
    return {{"stamp_ns", line.stamp_ns}, {"level", name_of(line.level)}, {"text", line.text}};
}

Json map_payload(std::int64_t map_id, double resolution_m) {
    return {{"map_id", map_id},
            {"resolution_m", resolution_m},
            {"side_cells", TileGeometry::kSide},
            {"encoding", "zlib+base64"},
            {"unseen", TileImage::kUnseen}};
}

Json tile_payload(std::int64_t map_id, double resolution_m, const TileImage& image) {
    return {{"map_id", map_id},
            {"x_m", image.corner.x * resolution_m},
            {"y_m", image.corner.y * resolution_m},
            {"resolution_m", resolution_m},
            {"side_cells", TileGeometry::kSide},
            {"cells", to_base64(deflated(image))}};
}

std::string text_of(const Json& payload) {
    return payload.dump(-1, ' ', false, Json::error_handler_t::replace);
}

}  // namespace crspf::mqtt
