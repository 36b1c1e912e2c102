// What `crspf bench` measures of the drivers of serial and CAN sensors.
#pragma once

namespace crspf::cli {

inline constexpr const char* kScipUtm30lx = "scip/utm30lx";
inline constexpr const char* kCanWheels = "can/wheels";

/// Tells Google Benchmark of both: a scan of 1081 beams, written by the simulated sensor and read; a frame of a pair of
/// wheel counters. Items are scans and frames.
void register_stream_cases();

}  // namespace crspf::cli
