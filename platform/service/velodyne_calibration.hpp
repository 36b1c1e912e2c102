// db.xml, the file of corrections that comes with a Velodyne sensor.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "drivers/velodyne/velodyne_models.hpp"

namespace crspf {

/// The corrections of each laser of `model`, from degrees and centimetres. The file is boost::serialization's XML:
/// under boost_serialization/DB, points_/item/px holds a laser, minIntensity_/item and maxIntensity_/item its bounds.
/// Corrections that came with later sensors (the two-point calibration, the focus, the bounds) may be absent, as may
/// distLSB_, which must else be the model's unit. What only Velodyne's viewer uses is not read: colors_, enabled_,
/// intensity_, position_, orientation_.
/// Throws InputError, "NAME:LINE: reason; remedy", unless each laser of the model, and no other, stands in it once with
/// corrections that a sensor can have.
/// @param name of the file, for messages
[[nodiscard]] VelodyneCalibration parse_velodyne_calibration(std::string_view text, const std::string& name,
                                                             VelodyneModel model);

/// The same, of a file. Not for real-time threads.
[[nodiscard]] VelodyneCalibration read_velodyne_calibration(const std::filesystem::path& file, VelodyneModel model);

}  // namespace crspf
