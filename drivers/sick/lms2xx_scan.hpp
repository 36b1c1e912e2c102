// An LMS2xx's values as a Scan.
#pragma once

#include "core/base/lidar_params.hpp"
#include "core/base/samples.hpp"
#include "core/base/time.hpp"
#include "drivers/sick/lms2xx_codec.hpp"

namespace crspf {

/// From the first beam to the last. Half and quarter degrees are measured in two and four turns. [s]
[[nodiscard]] double lms2xx_sweep_s(const Lms2xxVariant& variant);

/// Fills `scan` in REP-103's sense, seen upright or hanging as `lidar` says. False where the count is no variant's.
/// Half and quarter degrees are measured in two and four turns, so their time_per_beam_s is 0, unknown. The largest
/// values are codes: "nothing seen" is no return, the others are invalid. Wait-free.
bool fill_lms2xx_scan(const Lms2xxScan& raw, std::uint16_t value_mask, const LidarParams& lidar, Stamp beam0,
                      Scan& scan);

}  // namespace crspf
