// One line of a CARMEN log (carmen.sourceforge.net, logger_message formats): metres, radians, seconds.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "core/base/lidar_params.hpp"
#include "core/base/samples.hpp"

namespace crspf {

struct CarmenLine {
    enum class Kind : std::uint8_t {
        kIgnored,     ///< a message that is not ours, a comment, an empty line
        kDamaged,     ///< one of ours, but unusable; `damage` says why
        kRangeLimit,  ///< PARAM of the laser's largest range
        kOdometry,    ///< ODOM
        kFrontLaser,  ///< FLASER
        kRobotLaser,  ///< ROBOTLASER1
    };
    Kind kind = Kind::kIgnored;
    std::string damage;
    double stamp_s = 0.0;              ///< [s] ipc_timestamp
    std::optional<Pose2> P_odom_base;  ///< absolute odometry; none where it is not finite
    double range_limit_m = 0.0;        ///< [m] at or beyond: no return
};

/// For the two laser kinds `scan` is filled, its stamp counting from the line's (see finish_scan()); else its content
/// is unspecified. Never throws but for lack of memory; linear in the line.
[[nodiscard]] CarmenLine parse_carmen_line(std::string_view line, const LidarParams& lidar, Scan& scan);

/// Whether the line begins as only lines of CARMEN logs do. It may be cut off.
[[nodiscard]] bool looks_like_carmen(std::string_view line);

}  // namespace crspf
