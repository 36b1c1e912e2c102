// What `crspf bench` measures of the Velodyne driver.
#pragma once

namespace crspf::cli {

inline constexpr const char* kVelodyneVlp16 = "velodyne/vlp16";
inline constexpr const char* kVelodyneVlp32c = "velodyne/vlp32c";
inline constexpr const char* kVelodyneHdl32e = "velodyne/hdl32e";
inline constexpr const char* kVelodyneHdl64e = "velodyne/hdl64e_s2";

/// Tells Google Benchmark of a case for each model: a data packet into the revolution. Items are packets.
void register_velodyne_cases();

}  // namespace crspf::cli
