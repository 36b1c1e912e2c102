// Where and when each return of a packet was measured.
#pragma once

#include <array>
#include <cstdint>

#include "core/base/trig.hpp"
#include "drivers/velodyne/velodyne_codec.hpp"
#include "drivers/velodyne/velodyne_models.hpp"

namespace crspf {

inline constexpr std::uint32_t kVelodyneColumns = 24;  ///< of a packet, at most

/// One firing of all lasers, with one or two returns of each.
struct VelodyneColumn {
    double azimuth_cdeg = 0.0;    ///< at the column's first firing, interpolated between blocks; [0, 36000)
    double after_stamp_us = 0.0;  ///< first firing, after the packet's stamp
};

struct VelodyneColumns {
    std::uint32_t count = 0;
    std::uint32_t returns = 1;  ///< of each laser, 1 or 2
    std::array<VelodyneColumn, kVelodyneColumns> column{};
    std::array<double, kVelodyneColumns> turn_cdeg_per_us{};  ///< speed of the head during each column
    double last_firing_us = 0.0;                              ///< of the packet, after its stamp
};

/// The columns of a decoded packet. The azimuth between two blocks is linear in time; the last block goes on at the
/// speed of the one before (VLP-16 manual 9.5). False where the head would turn back by more than half a degree, or on
/// by more than two, from block to block: no sensor does that, damage does, and so does a sensor told to fire in a
/// sector. Wait-free.
[[nodiscard]] bool split(const VelodynePacket& packet, VelodyneModel model, VelodyneColumns& out);

/// The return `r` (0: the only or the last one, 1: the strongest) of a laser in a column.
[[nodiscard]] const VelodyneReturn& return_of(const VelodynePacket& packet, VelodyneModel model, std::uint32_t returns,
                                              std::uint32_t column, std::uint32_t laser, std::uint32_t r);

/// REP-103: x forward, y left, z up. [m]
struct VelodynePoint {
    double x_m = 0.0;
    double y_m = 0.0;
    double z_m = 0.0;
};

/// Turns azimuth and distance into points with the corrections of a unit; its tables are made once. Wait-free.
class VelodyneGeometry {
 public:
    VelodyneGeometry(VelodyneModel model, const VelodyneCalibration& calibration);

    /// @param direction of the azimuth at the column's first firing
    /// @param turn_rad_per_us by which the head has turned on when this laser fires; 0 leaves all on the first firing's
    /// @param distance of the return, not 0
    [[nodiscard]] VelodynePoint point(std::uint32_t laser, const SinCos& direction, double turn_rad_per_us,
                                      std::uint16_t distance) const;

    /// Reflectivity with the laser's focal correction.
    [[nodiscard]] std::uint8_t intensity(std::uint32_t laser, VelodyneReturn r) const;

 private:
    struct Laser {
        VelodyneLaser corrections;
        SinCos vertical{};
        SinCos rotation{};
        double firing_us = 0.0;
        bool two_points = false;
    };
    std::array<Laser, kVelodyneLasers> lasers_{};
};

}  // namespace crspf
