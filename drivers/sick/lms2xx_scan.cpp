#include "drivers/sick/lms2xx_scan.hpp"

#include <numbers>

namespace crspf {
namespace {

constexpr double kTurn_s = 1.0 / 75.0;
// Codes stand at the top of the range bits: these two say that nothing was seen.
constexpr unsigned kCodes = 8;

}  // namespace

double lms2xx_sweep_s(const Lms2xxVariant& variant) {
    const double turns = 100.0 / static_cast<double>(variant.resolution_cdeg);
    return (static_cast<double>(variant.angle_deg) / 360.0 + turns - 1.0) * kTurn_s;
}

bool fill_lms2xx_scan(const Lms2xxScan& raw, std::uint16_t value_mask, const LidarParams& lidar, Stamp beam0,
                      Scan& scan) {
    Lms2xxVariant variant;
    if (!variant_of_count(raw.count, variant)) {
        return false;
    }
    constexpr double kRadPerDegree = std::numbers::pi / 180.0;
    const double increment_deg = static_cast<double>(variant.resolution_cdeg) * 0.01;
    const double shift_deg = raw.partial ? 0.25 * raw.partial_index : 0.0;
    const double first_deg = shift_deg - 0.5 * static_cast<double>(variant.angle_deg);
    const std::size_t last = raw.count - std::size_t{1};
    const bool turned = lidar.mount_inverted;
    const bool one_turn = variant.resolution_cdeg == 100;
    const double beam_s = one_turn ? kTurn_s / 360.0 : 0.0;
    const auto steps = static_cast<double>(last);

    scan.count = raw.count;
    scan.angle_increment_rad = increment_deg * kRadPerDegree;
    scan.angle_min_rad = (turned ? -(first_deg + steps * increment_deg) : first_deg) * kRadPerDegree;
    scan.time_per_beam_s = turned ? -beam_s : beam_s;
    scan.stamp = beam0 + Duration::from_seconds(lidar.stamp_offset_s + (turned ? steps * beam_s : 0.0));
    const double scale_m = raw.unit == Lms2xxScan::Unit::kMillimetre ? 0.001 : 0.01;
    for (std::size_t i = 0; i <= last; ++i) {
        const std::size_t to = turned ? last - i : i;
        const unsigned value = raw.values[i] & unsigned{value_mask};
        scan.range_m[to] = static_cast<float>(value * scale_m);
        if (value + kCodes < value_mask) {
            scan.beam[to] = classify(scan.range_m[to], lidar);
        } else {
            scan.beam[to] = value == value_mask || value + kCodes == value_mask ? Beam::kNoReturn : Beam::kInvalid;
        }
    }
    return true;
}

}  // namespace crspf
