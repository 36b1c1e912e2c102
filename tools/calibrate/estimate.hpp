// The vehicle's constants by least squares (after A. Censi, A. Franchi, L. Marchionni, G. Oriolo, "Simultaneous
// calibration of odometry and sensor parameters for mobile robots", IEEE T-RO 29(2), 2013): between two scans the lidar
// moved as they were matched, and as the odometer tells where it is carried by the vehicle.
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "tools/calibrate/drive.hpp"
#include "tools/calibrate/unknowns.hpp"

namespace crspf::calibrate {

struct Estimate {
    double value = 0.0;   ///< in the core's units
    double stddev = 0.0;  ///< by what is left over
};

struct Calibration {
    std::vector<Estimate> estimates;  ///< of unknowns_of(), in its order
    std::size_t pieces = 0;           ///< of the drive, each from one scan to another
    double rest_m = 0.0;              ///< left over at a piece's end: its robust standard deviation
    double rest_rad = 0.0;
};

/// @param start  the unknowns' values in the configuration
/// None where the drive is too short, or the scans and the odometer are not of the same time.
[[nodiscard]] std::optional<Calibration> estimate(const Drive& drive, Odometer odometer, std::span<const double> start);

}  // namespace crspf::calibrate
