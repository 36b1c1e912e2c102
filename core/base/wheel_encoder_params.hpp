// What turns the counts of wheel encoders into metres.
#pragma once

namespace crspf {

/// Constants of a two-wheeled robot that a log of raw encoder counts needs.
struct WheelEncoderParams {
    double counts_per_turn = 2000.0;  ///< [counts]
    double wheel_radius_m = 0.077;    ///< [m]
};

}  // namespace crspf
