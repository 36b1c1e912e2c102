// Settings of a SCIP sensor.
#pragma once

#include <cstdint>

#include "drivers/scip/scip_codec.hpp"

namespace crspf {

struct ScipParams {
    /// Bit rate to stream with over RS-232; 0 for USB and Ethernet, which have none.
    std::uint32_t baud = 0;
    ScipEncoding encoding = ScipEncoding::kThreeChars;
    std::uint32_t cluster = 1;  ///< steps to a beam, 1-99
    std::uint32_t skip = 0;     ///< revolutions between scans, 0-9
    /// Learn the offset of the sensor's timer with TM at start, for some 100 ms. Without it the stamps are late by what
    /// lies between measurement and reception.
    bool synchronise = true;
};

}  // namespace crspf
