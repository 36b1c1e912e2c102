// The robot that `crspf sim` is told to simulate: from its options, and from the configuration of a real one.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "config/config.hpp"
#include "tools/sim/simulation.hpp"

namespace crspf::cli {

/// As the command line has them, in its units.
struct SimOptions {
    std::string world = "office";
    std::vector<double> start;  // x, y, heading in degrees
    std::optional<std::string> robot;
    std::string config;  // empty: none
    std::optional<double> speed_mps;
    double turn_rate_degps = 45.0;
    double gyro_bias_degps = 0.1;
    double bumps_deg = 0.0;
    std::optional<std::string> lidar;
    std::optional<double> scan_rate_hz;
    std::optional<double> max_range_m;
    std::optional<double> dropout;
    double range_noise = 1.0;
    double lidar_x_m = 0.145;
    double lidar_y_m = 0.0;
    double lidar_yaw_deg = 0.0;
    std::string path;
    std::string out = "sim";
    std::string format = "carmen";
    std::string capture;  // empty: none
    std::string stereo;   // empty: no folder of pictures
    std::vector<std::string> blind;
    bool plain = false;
    std::string odometer = "wheels";
    sim::SimulationParams params;
};

/// @param config what the robot carries; null: what the options tell
/// Throws InputError, which names the option or the key, where that cannot be simulated.
[[nodiscard]] sim::SimulationParams params_of(const SimOptions& options, const Config* config);

}  // namespace crspf::cli
