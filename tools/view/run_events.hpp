// What a run says of itself while it goes on, be it live or played again: the input of channels.hpp.
#pragma once

#include <cstdint>
#include <nlohmann/json.hpp>
#include <string>
#include <variant>
#include <vector>

#include "core/base/pose.hpp"
#include "core/slam/slam_params.hpp"
#include "platform/service/shown_map.hpp"

namespace crspf::view {

/// A scan that the filter has seen.
struct ScanEvent {
    std::int64_t stamp_ns = 0;  ///< [ns] of its first beam, UTC since 1970
    Pose2 P_map_base;           ///< P(t) where matched, else P~(t)
    Pose2 P_map_odom;           ///< the correction of the odometry's drift
    Covariance3 covariance;     ///< of P_map_base: m^2, m rad, rad^2
    double M = 0.0;             ///< filtered match value (11)
    double m = 0.0;             ///< match value (10)
    AnalyserParams thresholds;  ///< of (12) and (13), on the scale of M
    bool matched = false;
    bool result = false;  ///< Result of (12)
    bool draw = false;    ///< Draw of (13)
    bool lost = false;
    bool degenerate = false;  ///< some direction is not seen
    std::uint32_t rays = 0;
    std::uint32_t critical_rays = 0;
    std::uint32_t evaluations = 0;  ///< particles of the search and passes of the refinement
    double range_m = 0.0;           ///< half the width of the search
    double range_rad = 0.0;
    struct Point {
        float x_m = 0.0F;  ///< in base_link
        float y_m = 0.0F;
        bool critical = false;
    };
    std::vector<Point> points;  ///< hits; empty where nobody asked for them
};

struct TilesEvent {
    bool fresh = false;         ///< forget all tiles before: another map, or the beginning
    double resolution_m = 0.0;  ///< [m] side of a cell
    std::vector<TileImage> tiles;
};

/// The service's status document (docs/service.md), or a replay's.
// NOLINTNEXTLINE(bugprone-exception-escape): nlohmann::json, whose move throws nothing, although it calls what may
struct StatusEvent {
    std::int64_t stamp_ns = 0;
    nlohmann::ordered_json status;
};

struct LogLine {
    enum class Level : std::uint8_t { kDebug = 1, kInfo, kWarning, kError };  // foxglove.Log's numbers
    std::int64_t stamp_ns = 0;
    Level level = Level::kInfo;
    std::string text;
};

/// The feed has nobody to listen to: the service is away. False again: it is back.
struct AwayEvent {
    bool away = true;
    std::string why;
};

using RunEvent = std::variant<ScanEvent, TilesEvent, StatusEvent, LogLine, AwayEvent>;

}  // namespace crspf::view
