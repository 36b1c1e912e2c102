// One line of a `.dat` log, as the tinySLAM and BreezySLAM projects publish them: a two-wheeled robot with a Hokuyo
// URG-04LX. Blank-separated numbers: 0 stamp [us], 2 and 3 encoder counts left and right, the ranges [mm] at the end.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>

#include "core/base/lidar_params.hpp"
#include "core/base/samples.hpp"

namespace crspf {

struct UrgDatLine {
    std::string damage;         ///< why the line is unusable; empty: it is not
    double stamp_s = 0.0;       ///< [s]
    double left_counts = 0.0;   ///< [counts] of the encoder, since its start
    double right_counts = 0.0;  ///< [counts]
    std::size_t fields = 0;     ///< in the line: its neighbours must have as many, or it was cut off
};

/// Fills `scan`, its stamp counting from the line's (see finish_scan()), unless the line is damaged. The encoders are
/// of the line's stamp, the scan's first beam is 0.18 s older. The time per beam is the sensor's own unless `lidar`
/// gives one. Never throws but for lack of memory; linear in the line.
[[nodiscard]] UrgDatLine parse_urg_dat_line(std::string_view text, const LidarParams& lidar, Scan& scan);

/// Whether the line begins as only lines of this format do. It may be cut off.
[[nodiscard]] bool looks_like_urg_dat(std::string_view line);

}  // namespace crspf
