#include "platform/capture/urg_dat_line.hpp"

#include <array>
#include <cmath>
#include <limits>

#include "platform/capture/scan_beams.hpp"
#include "platform/files/fields.hpp"

namespace crspf {
namespace {

constexpr std::size_t kHeaderFields = 24;

// The URG-04LX by its data sheet: 1024 steps a turn at 10 Hz, step 384 ahead, steps 44 to 725 measured.
constexpr std::size_t kSensorBeams = 682;
constexpr double kStep_rad = 2.0 * kPi / 1024.0;
constexpr double kTurn_s = 0.1;
constexpr double kFirstEdge_rad = (44.0 - 0.5 - 384.0) * kStep_rad;
// The scan in a line is older than the encoders in it, which are taken to be of the line's stamp: its first beam by
// 0.18 s. Found by correlating the heading from scan matching with that of the encoders, in both published recordings.
constexpr Duration kScanAge{180'000'000};
constexpr float kErrorCodes_mm = 20.0F;  // below, a reading is no range but a code for why there is none

std::size_t count_fields(std::string_view line) {
    std::size_t count = 0;
    for (Fields fields(line); !fields.at_end(); ++count) {
        fields.word();
    }
    return count;
}

}  // namespace

UrgDatLine parse_urg_dat_line(std::string_view text, const LidarParams& lidar, Scan& scan) {
    UrgDatLine line;
    line.fields = count_fields(text);
    // The published logs hold one field more before the ranges than their own readers skip.
    const std::size_t header = line.fields == kHeaderFields + 1 + kSensorBeams ? kHeaderFields + 1 : kHeaderFields;
    if (line.fields <= header) {
        line.damage = std::to_string(line.fields) + " fields, no ranges behind the first " + std::to_string(header);
        return line;
    }
    Fields fields(text);
    std::array<double, 4> head{};
    auto& [stamp_us, status, left_counts, right_counts] = head;
    if (!fields.numbers(stamp_us, status, left_counts, right_counts) || !std::isfinite(stamp_us) ||
        !std::isfinite(left_counts) || !std::isfinite(right_counts)) {
        line.damage = "stamp or encoder counts are not finite numbers";
        return line;
    }
    line.stamp_s = stamp_us * 1e-6;
    line.left_counts = left_counts;
    line.right_counts = right_counts;
    for (std::size_t i = head.size(); i < header; ++i) {
        fields.word();
    }
    const std::size_t beams = line.fields - header;
    if (beams > capacity::kBeams) {
        line.damage = std::to_string(beams) + " beams, more than the " + std::to_string(capacity::kBeams) +
                      " of capacity::kBeams";
        return line;
    }
    for (std::size_t i = 0; i < beams; ++i) {
        float range_mm = 0.0F;
        if (!fields.number(range_mm)) {
            line.damage = "range " + std::to_string(i + 1) + " of " + std::to_string(beams) + " is not a number";
            return line;
        }
        const bool range = range_mm >= kErrorCodes_mm;
        set_beam(scan, i, range ? range_mm * 1e-3F : std::numeric_limits<float>::quiet_NaN(), lidar);
    }
    // However many beams a log keeps, they share the sector of the sensor evenly.
    scan.count = static_cast<std::uint32_t>(beams);
    const double steps_per_beam = static_cast<double>(kSensorBeams) / static_cast<double>(beams);
    const double increment_rad = steps_per_beam * kStep_rad;
    const double own_time_per_beam_s = steps_per_beam * kTurn_s / 1024.0;
    finish_scan(scan, kFirstEdge_rad + 0.5 * increment_rad, increment_rad,
                lidar.time_per_beam_s > 0.0 ? lidar.time_per_beam_s : own_time_per_beam_s, lidar);
    scan.stamp = scan.stamp - kScanAge;
    return line;
}

bool looks_like_urg_dat(std::string_view line) {
    Fields fields(line);
    double value = 0.0;
    for (std::size_t i = 0; i <= kHeaderFields; ++i) {
        if (!fields.number(value)) {
            return false;
        }
    }
    return true;
}

}  // namespace crspf
