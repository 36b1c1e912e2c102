// One revolution of a lidar of many lasers.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>

#include "config/capacities.hpp"
#include "core/base/samples.hpp"
#include "core/base/time.hpp"
#include "core/base/trig.hpp"

namespace crspf {

/// Columns in the order of their firing, clockwise; a struct of arrays. Points are in REP-103's axes: x forward (the
/// sensor's azimuth 0), y left, z up. [m] The stamps are on the host's line.
struct Cloud {
    std::uint32_t lasers = 0;
    std::uint32_t returns = 1;  ///< of each laser: 1, or 2 (0: last, 1: strongest)
    std::uint32_t columns = 0;
    std::uint32_t missing_columns = 0;                          ///< of these, in lost packets
    double cut_rad = kPi;                                       ///< azimuth, clockwise, at which revolutions begin
    std::array<std::uint8_t, capacity::kCloudLasers> upward{};  ///< the lasers, from the lowest to the highest
    /// From cut to cut. Otherwise the stream began, broke or ran out of room within; both ends are then open.
    bool complete = false;

    std::array<Stamp, capacity::kCloudColumns> stamp{};         ///< of the column's first firing
    std::array<double, capacity::kCloudColumns> azimuth_rad{};  ///< of the same, clockwise, in [0, 2 pi)
    std::array<bool, capacity::kCloudColumns> measured{};       ///< false: the packet was lost, all beams are kInvalid

    /// By at(). Coordinates mean something for Beam::kHit only. In a pair of two equal returns the second is kInvalid.
    std::array<float, capacity::kCloudPoints> x_m{};
    std::array<float, capacity::kCloudPoints> y_m{};
    std::array<float, capacity::kCloudPoints> z_m{};
    std::array<std::uint8_t, capacity::kCloudPoints> intensity{};
    std::array<Beam, capacity::kCloudPoints> beam{};

    /// As `other`, without touching what is not in use.
    void take(const Cloud& other) {
        lasers = other.lasers;
        returns = other.returns;
        columns = other.columns;
        missing_columns = other.missing_columns;
        cut_rad = other.cut_rad;
        upward = other.upward;
        complete = other.complete;
        std::copy_n(other.stamp.begin(), columns, stamp.begin());
        std::copy_n(other.azimuth_rad.begin(), columns, azimuth_rad.begin());
        std::copy_n(other.measured.begin(), columns, measured.begin());
        const std::size_t points = at(columns, 0);
        std::copy_n(other.x_m.begin(), points, x_m.begin());
        std::copy_n(other.y_m.begin(), points, y_m.begin());
        std::copy_n(other.z_m.begin(), points, z_m.begin());
        std::copy_n(other.intensity.begin(), points, intensity.begin());
        std::copy_n(other.beam.begin(), points, beam.begin());
    }

    [[nodiscard]] constexpr std::size_t at(std::uint32_t column, std::uint32_t laser, std::uint32_t r = 0) const {
        return (std::size_t{column} * returns + r) * lasers + laser;
    }

    /// How long the head takes to turn on. [s/rad] 0 where the cloud is no complete revolution.
    [[nodiscard]] double seconds_per_radian() const {
        constexpr std::uint32_t kFewestColumns = 16;  // the speed of fewer cannot be told
        if (!complete || columns < kFewestColumns) {
            return 0.0;
        }
        // The last column lies before the cut, hence less than a turn after the first.
        double turned_rad = azimuth_rad[columns - 1] - azimuth_rad[0];
        turned_rad += turned_rad <= 0.0 ? 2.0 * kPi : 0.0;
        const double s_per_rad = (stamp[columns - 1] - stamp[0]).seconds() / turned_rad;
        return s_per_rad > 0.0 ? s_per_rad : 0.0;
    }
};

}  // namespace crspf
