// One revolution of a Velodyne sensor.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "config/capacities.hpp"
#include "core/base/samples.hpp"
#include "core/base/time.hpp"
#include "drivers/velodyne/velodyne_models.hpp"

namespace crspf {

/// Columns in the order of their firing, hence clockwise; a struct of arrays. Points are in REP-103's axes: x forward
/// (the sensor's azimuth 0), y left, z up. [m] The stamps are on the host's line.
struct VelodyneCloud {
    VelodyneModel model = VelodyneModel::kVlp16;
    std::uint32_t lasers = 0;
    std::uint32_t returns = 1;  ///< of each laser: 1, or 2 (0: last, 1: strongest)
    std::uint32_t columns = 0;
    std::uint32_t missing_columns = 0;  ///< of these, in lost packets
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

    [[nodiscard]] constexpr std::size_t at(std::uint32_t column, std::uint32_t laser, std::uint32_t r = 0) const {
        return (std::size_t{column} * returns + r) * lasers + laser;
    }
};

}  // namespace crspf
