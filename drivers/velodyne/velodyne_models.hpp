// What differs between Velodyne's sensors: lasers, angles, the times of their firings, the corrections of a unit.
#pragma once

#include <array>
#include <cstdint>
#include <optional>

#include "config/capacities.hpp"
#include "core/base/time.hpp"

namespace crspf {

/// The HDL-64E does not name itself in its packets, and the S3 fires faster than the S2: both have to be configured.
enum class VelodyneModel : std::uint8_t { kVlp16, kPuckHiRes, kHdl32e, kHdl64eS2, kHdl64eS3, kVlp32c };

inline constexpr std::uint32_t kVelodyneLasers = capacity::kCloudLasers;  ///< at most
inline constexpr std::uint32_t kVelodyneBlocks = 12;                      ///< of a data packet
inline constexpr std::uint32_t kVelodyneReturns = 32;                     ///< of a block

/// A column is one firing of all lasers; a packet holds 384 returns, whatever the model.
struct VelodyneTraits {
    std::uint32_t lasers;
    std::uint32_t columns_per_block;  ///< 2 for 16 lasers, 1 for 32; a column of 64 lasers takes two blocks
    double distance_unit_m;
    std::uint32_t lasers_at_once;  ///< of a block
    double laser_us;               ///< from these lasers' firing to the next ones'
    double column_us;              ///< from a column to the next within a packet
    double first_firing_us;        ///< of the packet after the packet's stamp
    double packet_us;              ///< from a packet to the next, one return per laser; half of that with two
};

/// Sources: VLP-16 manual 63-9243 chapter 9; HDL-32E manual appendix E, which stamps a packet at its last firing and
/// lets its lasers fire one by one, 1.152 us apart (some drivers take them to fire in pairs, as the VLP-32C's do);
/// HDL-64E S2 manual appendix G for the firings, the S2 and S3 data rates for the packets; VLP-32C manual 63-9325
/// chapter 9: pairs every 2.304 us, which share an azimuth (its pseudo code in 9.5 lets them turn on twice as far).
[[nodiscard]] const VelodyneTraits& traits_of(VelodyneModel model);

/// By the product byte that VLP-16, Puck Hi-Res, VLP-32C and newer HDL-32E send; none for any other value.
[[nodiscard]] std::optional<VelodyneModel> model_of_product(std::uint8_t product);
/// 0 for the HDL-64E, whose packets have status bytes there.
[[nodiscard]] std::uint8_t product_of_model(VelodyneModel model);
[[nodiscard]] constexpr bool is_hdl64e(VelodyneModel model) {
    return model == VelodyneModel::kHdl64eS2 || model == VelodyneModel::kHdl64eS3;
}

/// Corrections of one laser. Names and meaning are those of Velodyne's db.xml; all but the vertical angle are 0 for the
/// sensors of 16 and 32 lasers, but for the VLP-32C's rotation. Rotation is subtracted from the azimuth: a laser of
/// positive rotation looks to the left of where the sensor does. VLP-32C manuals print the opposite, an offset to add.
struct VelodyneLaser {
    double vertical_rad = 0.0;
    double rotation_rad = 0.0;
    double distance_m = 0.0;    ///< at 25.04 m
    double distance_x_m = 0.0;  ///< at x 2.40 m; the two-point correction needs this and the next to be non-zero
    double distance_y_m = 0.0;  ///< at y 1.93 m
    double vertical_offset_m = 0.0;
    double horizontal_offset_m = 0.0;
    double focal_distance_m = 0.0;
    double focal_slope = 0.0;
    std::uint8_t min_intensity = 0;
    std::uint8_t max_intensity = 255;
};

/// In the order of the packet; the HDL-64E's upper bank comes first.
using VelodyneCalibration = std::array<VelodyneLaser, kVelodyneLasers>;

/// None for the HDL-64E: it differs from unit to unit, and the unit tells (velodyne_status.hpp).
[[nodiscard]] std::optional<VelodyneCalibration> nominal_calibration(VelodyneModel model);

/// When laser `laser` of a column fires, after the column's first.
[[nodiscard]] double firing_us(VelodyneModel model, std::uint32_t laser);

/// The laser whose angle is nearest to the horizon; of equal ones the first.
[[nodiscard]] std::uint32_t most_level_laser(VelodyneModel model, const VelodyneCalibration& calibration);

/// The lasers of the model, the rest is 0, from the one that looks lowest to the one that looks highest.
[[nodiscard]] std::array<std::uint8_t, kVelodyneLasers> lasers_upward(VelodyneModel model,
                                                                      const VelodyneCalibration& calibration);

}  // namespace crspf
