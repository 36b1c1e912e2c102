// Settings of a Velodyne sensor.
#pragma once

#include <cstdint>
#include <optional>

#include "drivers/velodyne/velodyne_models.hpp"

namespace crspf {

struct VelodyneParams {
    VelodyneModel model = VelodyneModel::kVlp16;
    std::uint32_t source_address = 0xC0A801C9;  ///< IPv4 of the sensor, 192.168.1.201; others are not believed
    double cut_rad = 3.14159265358979323846;    ///< azimuth, clockwise, at which a revolution begins: behind
};

struct VelodyneScanParams {
    std::uint32_t beams = 1800;          ///< of a full turn, 1 to capacity::kBeams
    std::optional<std::uint32_t> laser;  ///< which ring; none: the one nearest to the horizon
};

}  // namespace crspf
