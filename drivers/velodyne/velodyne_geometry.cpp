#include "drivers/velodyne/velodyne_geometry.hpp"

#include <algorithm>

#include "core/base/real.hpp"

namespace crspf {
namespace {

constexpr int kMostBack_cdeg = 50;
constexpr int kMostOn_cdeg = 200;
// Distances of the two calibration targets.
constexpr double kFar_m = 25.04;
constexpr double kNearX_m = 2.40;
constexpr double kNearY_m = 1.93;
// Distance at which the focal correction's parabola ends.
constexpr double kFocalEnd_m = 131.0;

/// In [-half a turn, half a turn).
constexpr int signed_turn(int cdeg) {
    const int turned = ((cdeg % kVelodyneTurn_cdeg) + kVelodyneTurn_cdeg) % kVelodyneTurn_cdeg;
    return turned < kVelodyneTurn_cdeg / 2 ? turned : turned - kVelodyneTurn_cdeg;
}

/// Blocks that are fired together: the banks of the HDL-64E, or the returns of a pair.
constexpr std::uint32_t blocks_together(VelodyneModel model, std::uint32_t returns) {
    return is_hdl64e(model) ? 2 : returns;
}

/// Sine and cosine of a few degrees at most, to 1e-10.
constexpr SinCos small_sin_cos(double rad) {
    const double square_rad = rad * rad;
    return {rad * (1.0 - square_rad * (1.0 / 6.0)), 1.0 - square_rad * (0.5 - square_rad * (1.0 / 24.0))};
}

constexpr SinCos sum(const SinCos& a, const SinCos& b) {
    return {a.sin * b.cos + a.cos * b.sin, a.cos * b.cos - a.sin * b.sin};
}

constexpr SinCos difference(const SinCos& a, const SinCos& b) {
    return {a.sin * b.cos - a.cos * b.sin, a.cos * b.cos + a.sin * b.sin};
}

/// What the two-point calibration adds to the distance along one axis, `at_m` from the sensor along it.
constexpr double along_axis(double far_m, double near_m, double at_m, double near_target_m) {
    return (far_m - near_m) * (at_m - near_target_m) / (kFar_m - near_target_m) + near_m - far_m;
}

}  // namespace

bool split(const VelodynePacket& packet, VelodyneModel model, VelodyneColumns& out) {
    const VelodyneTraits& traits = traits_of(model);
    out.returns = is_dual(model, packet) ? 2 : 1;
    const std::uint32_t together = blocks_together(model, out.returns);
    const double group_us = traits.column_us * static_cast<double>(traits.columns_per_block);
    out.count = 0;
    int step_cdeg = 0;
    for (std::uint32_t b = 0; b < kVelodyneBlocks; b += together) {
        const int azimuth_cdeg = packet.blocks[b].azimuth_cdeg;
        if (b + together < kVelodyneBlocks) {
            step_cdeg = signed_turn(packet.blocks[b + together].azimuth_cdeg - azimuth_cdeg);
            if (step_cdeg < -kMostBack_cdeg || step_cdeg > kMostOn_cdeg) {
                return false;
            }
        }
        const double speed = static_cast<double>(step_cdeg) / group_us;
        for (std::uint32_t c = 0; c < traits.columns_per_block; ++c) {
            const double in_group_us = traits.column_us * static_cast<double>(c);
            double at_cdeg = static_cast<double>(azimuth_cdeg) + speed * in_group_us;
            at_cdeg += at_cdeg < 0.0 ? kVelodyneTurn_cdeg : 0.0;
            at_cdeg -= at_cdeg >= kVelodyneTurn_cdeg ? kVelodyneTurn_cdeg : 0.0;
            const std::uint32_t group = b / together;
            out.column[out.count] = {at_cdeg, traits.first_firing_us + group_us * group + in_group_us};
            out.turn_cdeg_per_us[out.count] = speed;
            ++out.count;
        }
    }
    out.last_firing_us = out.column[out.count - 1].after_stamp_us + firing_us(model, traits.lasers - 1);
    return true;
}

const VelodyneReturn& return_of(const VelodynePacket& packet, VelodyneModel model, std::uint32_t returns,
                                std::uint32_t column, std::uint32_t laser, std::uint32_t r) {
    const VelodyneTraits& traits = traits_of(model);
    const std::uint32_t bank = laser / kVelodyneReturns;
    const std::uint32_t block = column / traits.columns_per_block * blocks_together(model, returns) + r + bank;
    const std::uint32_t at = column % traits.columns_per_block * traits.lasers + laser % kVelodyneReturns;
    return packet.blocks[block].returns[at];
}

VelodyneGeometry::VelodyneGeometry(VelodyneModel model, const VelodyneCalibration& calibration) {
    for (std::uint32_t i = 0; i < kVelodyneLasers; ++i) {
        const VelodyneLaser& c = calibration[i];
        lasers_[i] = {.corrections = c,
                      .vertical = sin_cos(c.vertical_rad),
                      .rotation = sin_cos(c.rotation_rad),
                      .firing_us = firing_us(model, i),
                      .two_points = c.distance_x_m != 0.0 && c.distance_y_m != 0.0};
    }
}

VelodynePoint VelodyneGeometry::point(std::uint32_t laser, const SinCos& direction, double turn_rad_per_us,
                                      std::uint16_t distance) const {
    const Laser& l = lasers_[laser];
    const VelodyneLaser& c = l.corrections;
    const SinCos now = sum(direction, small_sin_cos(turn_rad_per_us * l.firing_us));
    const SinCos beta = difference(now, l.rotation);
    const double range_m = static_cast<double>(distance) * kVelodyneDistanceUnit_m + c.distance_m;
    const double down_m = c.vertical_offset_m * l.vertical.sin;
    const double left_m = c.horizontal_offset_m;
    double along_x_m = range_m;
    double along_y_m = range_m;
    if (l.two_points) {
        const double flat_m = range_m * l.vertical.cos - down_m;
        const double x_m = absolute(flat_m * beta.sin - left_m * beta.cos);
        const double y_m = absolute(flat_m * beta.cos + left_m * beta.sin);
        along_x_m += along_axis(c.distance_m, c.distance_x_m, x_m, kNearX_m);
        along_y_m += along_axis(c.distance_m, c.distance_y_m, y_m, kNearY_m);
    }
    // The sensor's own axes: x right, y forward.
    const double x_m = (along_x_m * l.vertical.cos - down_m) * beta.sin - left_m * beta.cos;
    const double y_m = (along_y_m * l.vertical.cos - down_m) * beta.cos + left_m * beta.sin;
    return {.x_m = y_m, .y_m = -x_m, .z_m = along_y_m * l.vertical.sin + c.vertical_offset_m * l.vertical.cos};
}

std::uint8_t VelodyneGeometry::intensity(std::uint32_t laser, VelodyneReturn r) const {
    const VelodyneLaser& c = lasers_[laser].corrections;
    const double focus = 256.0 * square(1.0 - c.focal_distance_m / kFocalEnd_m);
    const double here = 256.0 * square(1.0 - static_cast<double>(r.distance) / 65535.0);
    const double corrected = static_cast<double>(r.reflectivity) + c.focal_slope * absolute(focus - here);
    // By hand: std::clamp must not be asked with a lower bound above the upper one, as a damaged table may hold.
    const double floored = std::max(corrected, static_cast<double>(c.min_intensity));
    return static_cast<std::uint8_t>(std::min(floored, static_cast<double>(c.max_intensity)));
}

}  // namespace crspf
