// What `crspf bench` measures of the Velodyne driver.
#pragma once

#include "drivers/velodyne/velodyne_models.hpp"

namespace crspf::cli {

inline constexpr const char* kVelodyneVlp16 = "velodyne/vlp16";
inline constexpr const char* kVelodyneVlp32c = "velodyne/vlp32c";
inline constexpr const char* kVelodyneHdl32e = "velodyne/hdl32e";
inline constexpr const char* kVelodyneHdl64e = "velodyne/hdl64e_s2";

/// The nominal one; of an HDL-64E, each unit of which has its own, one with which every correction is at work.
[[nodiscard]] VelodyneCalibration bench_calibration(VelodyneModel model);

/// Tells Google Benchmark of a case for each model: a data packet into the revolution. Items are packets.
void register_velodyne_cases();

}  // namespace crspf::cli
