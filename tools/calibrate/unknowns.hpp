// What is looked for: a vehicle's odometry and where its lidar is, as [odometry] and [lidar] of the configuration.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string_view>
#include <utility>
#include <vector>

#include "config/config.hpp"
#include "core/base/pose.hpp"
#include "core/base/time.hpp"
#include "tools/calibrate/drive.hpp"

namespace crspf::calibrate {

enum class Odometer : std::uint8_t {
    kWheels,  ///< two of a differential drive
    kCar,     ///< speed and steering angle
    kImu,     ///< speed and yaw rate
};

struct Unknown {
    std::string_view section;
    std::string_view key;
    std::string_view unit;         ///< of the configuration
    double per_unit;               ///< of the core's unit in one of the configuration: radians in a degree
    double (*get)(const Config&);  ///< in the core's units, as all below
    void (*set)(Config&, double);
    double belief;              ///< standard deviation of what a maker tells, at its worst
    double wanted;              ///< a standard deviation above this finds nothing worth writing down
    std::string_view shown_by;  ///< the motion that tells it
};

/// Those of an odometer, then those of the lidar: x, y, yaw, stamp offset.
[[nodiscard]] std::span<const Unknown> unknowns_of(Odometer odometer);

struct Moment {
    Stamp stamp;
    Pose2 P_odom_base;
};

/// P_odom_base at a stamp. None beyond the way's ends.
[[nodiscard]] std::optional<Pose2> place_at(const std::vector<Moment>& way, Stamp stamp);

/// The way that the odometer alone tells, with these values of its unknowns.
[[nodiscard]] std::vector<Moment> way_of(const Drive& drive, Odometer odometer, std::span<const double> values);

}  // namespace crspf::calibrate
