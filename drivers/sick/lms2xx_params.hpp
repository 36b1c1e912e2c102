// Settings of an LMS2xx on a serial line.
#pragma once

#include <cstdint>

#include "drivers/sick/lms2xx_codec.hpp"

namespace crspf {

struct Lms2xxParams {
    std::uint32_t baud = 38400;  ///< 9600, 19200, 38400, or 500000 (RS-422), which alone carries every scan
    Lms2xxVariant variant;       ///< field of view and resolution
    /// Bits of a value that are its range, by the measuring mode that the sensor was left in: 0x1FFF for 8 m and 80 m
    /// (from the factory), 0x3FFF for 16 m, 0x7FFF for 32 m. The bits above are its flags.
    std::uint16_t value_mask = 0x1FFF;
};

}  // namespace crspf
