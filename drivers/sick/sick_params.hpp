// Settings of a SICK lidar on TCP.
#pragma once

#include <cstdint>
#include <optional>

#include "drivers/sick/cola_codec.hpp"

namespace crspf {

/// Which dialect the sensor is to speak.
enum class SickDialect : std::uint8_t {
    kAsFound,  ///< the one it answers in
    kBinary,   ///< switched to where it speaks the other: half the bytes, and a sum
    kAscii,
};

struct SickParams {
    SickDialect dialect = SickDialect::kAsFound;
    std::optional<SickScanConfig> scan;  ///< set at the start; not stored in the sensor. None: as the sensor is.
    bool configure_output = true;        ///< ask for the first echo, 16 bit, every scan
};

}  // namespace crspf
