// Where and when each return of a packet was measured.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "core/base/kernel.hpp"
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

/// Lasers of one column whose returns stand side by side in a block: all of them, or a bank of the HDL-64E.
struct VelodyneReturns {
    std::span<const std::uint16_t> distance;     ///< in VelodyneTraits::distance_unit_m; 0: no return
    std::span<const std::uint8_t> reflectivity;  ///< as many
};

/// The return `r` (0: the only or the last one, 1: the strongest) of a column's lasers: of 32 in a bank, or of all.
[[nodiscard]] VelodyneReturns returns_of(const VelodynePacket& packet, VelodyneModel model, std::uint32_t returns,
                                         std::uint32_t column, std::uint32_t bank, std::uint32_t r);

/// Points as the cloud holds them. REP-103: x forward, y left, z up. [m]
struct VelodynePoints {
    std::span<float> x_m;
    std::span<float> y_m;
    std::span<float> z_m;
    std::span<std::uint8_t> intensity;
};

/// Turns azimuth and distance into points with the corrections of a unit; its tables are made once. Computed in double,
/// rounded to float once, by the same operations for each laser and model: loops without branches, which compilers
/// vectorise, for AVX2 where the processor has it, without touching a bit of the result. Wait-free. One owner.
class VelodyneGeometry {
 public:
    VelodyneGeometry(VelodyneModel model, const VelodyneCalibration& calibration, Kernel kernel = Kernel::kFastest);

    /// How fast the head turns during the columns to come: each laser fires later than the column's first, and by then
    /// the head has turned on. 0 leaves all at the first firing's azimuth.
    void aim(double turn_rad_per_us);

    /// The points of lasers `first` to `first` + 15, or + 31. Where the distance is 0 they mean nothing.
    /// @param direction of the azimuth at the column's first firing
    /// @param out as many as there are returns
    void place(std::uint32_t first, const SinCos& direction, const VelodyneReturns& returns,
               const VelodynePoints& out) const;

 private:
    using PerLaser = std::array<double, kVelodyneLasers>;

    struct Aim;
    void fill(Aim& aim) const;
    template <std::size_t Lasers>
    void place_lasers(std::uint32_t first, const SinCos& direction, const VelodyneReturns& returns,
                      const VelodynePoints& out) const;
    template <std::size_t Lasers>
    void focus_lasers(std::uint32_t first, const VelodyneReturns& returns, std::uint8_t* out) const;
    void place_all(std::uint32_t first, const SinCos& direction, const VelodyneReturns& returns,
                   const VelodynePoints& out) const;
    void place_all_avx2(std::uint32_t first, const SinCos& direction, const VelodyneReturns& returns,
                        const VelodynePoints& out) const;

    double unit_m_;
    bool avx2_;
    bool focused_ = false;  ///< a laser has a focal correction, or bounds of its intensity

    /// Where the lasers look when they fire, seen from the column's azimuth.
    struct Aim {
        double turn_rad_per_us = 0.0;
        PerLaser sin{};
        PerLaser cos{};
    };
    /// The speed is told in whole hundredths of a degree from block to block: it jumps to and fro between a few values.
    static constexpr std::size_t kAims = 4;
    std::array<Aim, kAims> aims_{};
    std::size_t aim_ = 0;     ///< the one in use
    std::size_t oldest_ = 0;  ///< the one to be replaced

    PerLaser firing_us_{};
    PerLaser rotation_sin_{};
    PerLaser rotation_cos_{};
    PerLaser vertical_sin_{};
    PerLaser vertical_cos_{};
    PerLaser distance_m_{};
    PerLaser down_m_{};  ///< how much nearer a laser's vertical offset makes a point, along the ground
    PerLaser up_m_{};
    PerLaser left_m_{};
    // What the two-point calibration adds to the distance along an axis: slope times the way along it, and a constant.
    PerLaser slope_x_{};
    PerLaser slope_y_{};
    PerLaser constant_x_m_{};
    PerLaser constant_y_m_{};

    std::array<float, kVelodyneLasers> focal_slope_{};
    std::array<float, kVelodyneLasers> focus_{};
    std::array<float, kVelodyneLasers> least_{};
    std::array<float, kVelodyneLasers> most_{};
};

}  // namespace crspf
