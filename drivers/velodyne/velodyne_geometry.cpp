#include "drivers/velodyne/velodyne_geometry.hpp"

#include <algorithm>
#include <cmath>  // fabs

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

constexpr SinCos difference(const SinCos& a, const SinCos& b) {
    return {a.sin * b.cos - a.cos * b.sin, a.cos * b.cos + a.sin * b.sin};
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

VelodyneReturns returns_of(const VelodynePacket& packet, VelodyneModel model, std::uint32_t returns,
                           std::uint32_t column, std::uint32_t bank, std::uint32_t r) {
    const VelodyneTraits& traits = traits_of(model);
    const std::uint32_t group = column / traits.columns_per_block;
    const std::size_t begin = std::size_t{column % traits.columns_per_block} * traits.lasers;
    const VelodyneBlock& block = packet.blocks[group * blocks_together(model, returns) + r + bank];
    const std::size_t count = std::min(traits.lasers, kVelodyneReturns);
    return {.distance = std::span(block.distance).subspan(begin, count),
            .reflectivity = std::span(block.reflectivity).subspan(begin, count)};
}

VelodyneGeometry::VelodyneGeometry(VelodyneModel model, const VelodyneCalibration& calibration, Kernel kernel)
    : unit_m_(traits_of(model).distance_unit_m), avx2_(takes_avx2(kernel)) {
    for (std::uint32_t i = 0; i < kVelodyneLasers; ++i) {
        const VelodyneLaser& c = calibration[i];
        const SinCos vertical = sin_cos(c.vertical_rad);
        const SinCos rotation = sin_cos(c.rotation_rad);
        firing_us_[i] = firing_us(model, i);
        rotation_sin_[i] = rotation.sin;
        rotation_cos_[i] = rotation.cos;
        vertical_sin_[i] = vertical.sin;
        vertical_cos_[i] = vertical.cos;
        distance_m_[i] = c.distance_m;
        down_m_[i] = c.vertical_offset_m * vertical.sin;
        up_m_[i] = c.vertical_offset_m * vertical.cos;
        left_m_[i] = c.horizontal_offset_m;
        if (c.distance_x_m != 0.0 && c.distance_y_m != 0.0) {
            slope_x_[i] = (c.distance_m - c.distance_x_m) / (kFar_m - kNearX_m);
            slope_y_[i] = (c.distance_m - c.distance_y_m) / (kFar_m - kNearY_m);
            constant_x_m_[i] = c.distance_x_m - c.distance_m - slope_x_[i] * kNearX_m;
            constant_y_m_[i] = c.distance_y_m - c.distance_m - slope_y_[i] * kNearY_m;
        }
        focal_slope_[i] = static_cast<float>(c.focal_slope);
        focus_[i] = static_cast<float>(256.0 * square(1.0 - c.focal_distance_m / kFocalEnd_m));
        least_[i] = static_cast<float>(c.min_intensity);
        most_[i] = static_cast<float>(c.max_intensity);
        focused_ = focused_ || c.focal_slope != 0.0 || c.min_intensity > 0 || c.max_intensity < 255;
    }
    for (Aim& aim : aims_) {
        fill(aim);
    }
}

void VelodyneGeometry::fill(Aim& aim) const {
    for (std::size_t i = 0; i < kVelodyneLasers; ++i) {
        const SinCos turned = small_sin_cos(aim.turn_rad_per_us * firing_us_[i]);
        const SinCos at = difference(turned, {rotation_sin_[i], rotation_cos_[i]});
        aim.sin[i] = at.sin;
        aim.cos[i] = at.cos;
    }
}

void VelodyneGeometry::aim(double turn_rad_per_us) {
    for (std::size_t a = 0; a < kAims; ++a) {
        if (aims_[a].turn_rad_per_us == turn_rad_per_us) {
            aim_ = a;
            return;
        }
    }
    aim_ = oldest_;
    oldest_ = (oldest_ + 1) % kAims;
    aims_[aim_].turn_rad_per_us = turn_rad_per_us;
    fill(aims_[aim_]);
}

// Inlined into each kernel and compiled for its processor.
template <std::size_t Lasers>
[[gnu::always_inline]] inline void VelodyneGeometry::place_lasers(std::uint32_t first, const SinCos& direction,
                                                                  const VelodyneReturns& returns,
                                                                  const VelodynePoints& out) const {
    const Aim& aim = aims_[aim_];
    const std::uint16_t* const distance = returns.distance.data();
    float* const x_m = out.x_m.data();
    float* const y_m = out.y_m.data();
    float* const z_m = out.z_m.data();
    for (std::size_t j = 0; j < Lasers; ++j) {
        const std::size_t i = first + j;
        const double beta_sin = direction.sin * aim.cos[i] + direction.cos * aim.sin[i];
        const double beta_cos = direction.cos * aim.cos[i] - direction.sin * aim.sin[i];
        const double range_m = static_cast<double>(distance[j]) * unit_m_ + distance_m_[i];
        const double flat_m = range_m * vertical_cos_[i] - down_m_[i];
        // The sensor's own axes: right and ahead; first without the two-point calibration.
        const double right_m = flat_m * beta_sin - left_m_[i] * beta_cos;
        const double ahead_m = flat_m * beta_cos + left_m_[i] * beta_sin;
        const double more_x_m = slope_x_[i] * std::fabs(right_m) + constant_x_m_[i];
        const double more_y_m = slope_y_[i] * std::fabs(ahead_m) + constant_y_m_[i];
        x_m[j] = static_cast<float>(ahead_m + more_y_m * vertical_cos_[i] * beta_cos);
        y_m[j] = static_cast<float>(-(right_m + more_x_m * vertical_cos_[i] * beta_sin));
        z_m[j] = static_cast<float>((range_m + more_y_m) * vertical_sin_[i] + up_m_[i]);
    }
}

template <std::size_t Lasers>
[[gnu::always_inline]] inline void VelodyneGeometry::focus_lasers(std::uint32_t first, const VelodyneReturns& returns,
                                                                  std::uint8_t* out) const {
    const std::uint16_t* const distance = returns.distance.data();
    const std::uint8_t* const reflectivity = returns.reflectivity.data();
    std::array<std::uint8_t, Lasers> intensity{};
    for (std::size_t j = 0; j < Lasers; ++j) {
        const std::size_t i = first + j;
        const float off = 1.0F - static_cast<float>(distance[j]) * (1.0F / 65535.0F);
        const float apart = focus_[i] - 256.0F * (off * off);
        const float corrected = static_cast<float>(reflectivity[j]) + focal_slope_[i] * (apart < 0.0F ? -apart : apart);
        // By hand: std::clamp must not be asked with a lower bound above the upper one, as a damaged table may hold.
        const float floored = corrected > least_[i] ? corrected : least_[i];
        const float bounded = floored < most_[i] ? floored : most_[i];
        intensity[j] = static_cast<std::uint8_t>(static_cast<int>(bounded));
    }
    std::copy(intensity.begin(), intensity.end(), out);
}

[[gnu::always_inline]] inline void VelodyneGeometry::place_all(std::uint32_t first, const SinCos& direction,
                                                               const VelodyneReturns& returns,
                                                               const VelodynePoints& out) const {
    const bool bank = returns.distance.size() == kVelodyneReturns;
    if (bank) {
        place_lasers<kVelodyneReturns>(first, direction, returns, out);
    } else {
        place_lasers<kVelodyneReturns / 2>(first, direction, returns, out);
    }
    if (!focused_) {
        std::copy(returns.reflectivity.begin(), returns.reflectivity.end(), out.intensity.begin());
    } else if (bank) {
        focus_lasers<kVelodyneReturns>(first, returns, out.intensity.data());
    } else {
        focus_lasers<kVelodyneReturns / 2>(first, returns, out.intensity.data());
    }
}

#if defined(__x86_64__)
[[gnu::target("avx2")]]
#endif
void VelodyneGeometry::place_all_avx2(std::uint32_t first, const SinCos& direction, const VelodyneReturns& returns,
                                      const VelodynePoints& out) const {
    place_all(first, direction, returns, out);
}

void VelodyneGeometry::place(std::uint32_t first, const SinCos& direction, const VelodyneReturns& returns,
                             const VelodynePoints& out) const {
    if (avx2_) {
        place_all_avx2(first, direction, returns, out);
    } else {
        place_all(first, direction, returns, out);
    }
}

}  // namespace crspf
