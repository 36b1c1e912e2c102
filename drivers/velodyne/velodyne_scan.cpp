#include "drivers/velodyne/velodyne_scan.hpp"

#include <algorithm>

#include "core/base/real.hpp"
#include "core/base/trig.hpp"

namespace crspf {
namespace {

constexpr double kTurn_rad = 2.0 * kPi;

}  // namespace

VelodyneScanner::VelodyneScanner(const VelodyneScanParams& params, VelodyneModel model,
                                 const VelodyneCalibration& calibration)
    : model_(model),
      beams_(std::clamp<std::uint32_t>(params.beams, 1, capacity::kBeams)),
      laser_(std::min(params.laser.value_or(most_level_laser(model, calibration)), traits_of(model).lasers - 1)),
      firing_s_(firing_us(model, laser_) * 1e-6),
      rotation_rad_(calibration[laser_].rotation_rad) {}

bool VelodyneScanner::scan(const VelodyneCloud& cloud, double cut_rad, Scan& out) {
    out.count = 0;
    const double s_per_rad = cloud.seconds_per_radian();
    if (cloud.model != model_ || !(s_per_rad > 0.0)) {
        return false;
    }
    const double first_rad = cloud.azimuth_rad[0];
    out.count = beams_;
    out.angle_increment_rad = kTurn_rad / beams_;
    // Beam 0 lies half a beam before the cut, seen in the sense of the sensor's turn.
    out.angle_min_rad = wrap_angle(-cut_rad + 0.5 * out.angle_increment_rad);
    out.time_per_beam_s = -s_per_rad * out.angle_increment_rad;
    std::fill_n(out.beam.begin(), beams_, Beam::kInvalid);
    std::fill_n(aside_.begin(), beams_, 1.0F);

    const double ahead_rad = firing_s_ / s_per_rad - rotation_rad_;
    const double first_after_cut_rad = wrap_angle(first_rad - cut_rad);
    const double beam0_after_first_rad = kTurn_rad - 0.5 * out.angle_increment_rad - first_after_cut_rad;
    out.stamp = cloud.stamp[0] + Duration::from_seconds(s_per_rad * (beam0_after_first_rad - ahead_rad) + firing_s_);

    for (std::uint32_t c = 0; c < cloud.columns; ++c) {
        if (!cloud.measured[c]) {
            continue;
        }
        const double after_cut_rad = cloud.azimuth_rad[c] + ahead_rad - cut_rad;
        const double left_rad = -after_cut_rad;  // counter-clockwise from the cut
        double place = left_rad / out.angle_increment_rad;
        place -= static_cast<double>(beams_) * static_cast<double>(static_cast<std::int64_t>(place / beams_));
        place += place < 0.0 ? static_cast<double>(beams_) : 0.0;
        const std::uint32_t beam = std::min(static_cast<std::uint32_t>(place), beams_ - 1);
        const auto aside = static_cast<float>(absolute(place - static_cast<double>(beam) - 0.5));
        if (aside >= aside_[beam]) {
            continue;
        }
        aside_[beam] = aside;
        const std::size_t i = cloud.at(c, laser_);
        out.beam[beam] = cloud.beam[i];
        if (cloud.beam[i] == Beam::kHit) {
            const auto x_m = static_cast<double>(cloud.x_m[i]);
            const auto y_m = static_cast<double>(cloud.y_m[i]);
            out.range_m[beam] = static_cast<float>(square_root(x_m * x_m + y_m * y_m));
        }
    }
    return true;
}

}  // namespace crspf
