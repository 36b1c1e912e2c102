// The time loop: people walk, cars drive, the driver steers, the robot moves, the lidar turns, and the log grows.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <string_view>
#include <vector>

#include "core/base/pose.hpp"
#include "platform/files/trajectory.hpp"
#include "tools/sim/lidar_model.hpp"
#include "tools/sim/log_writer.hpp"
#include "tools/sim/robot.hpp"
#include "tools/sim/scene.hpp"
#include "tools/sim/stereo_rig.hpp"

namespace crspf::sim {

/// What the base of the robot tells in a capture.
/// kInertial: an IMU of six axes, kGyro: a yaw rate; neither with a speed.
enum class Odometer : std::uint8_t { kWheels, kImu, kSteering, kInertial, kGyro };

struct SimulationParams {
    RobotParams robot;
    LidarModel lidar;
    Pose2 P_base_lidar;
    double odometry_rate_hz = 50.0;
    Odometer odometer = Odometer::kWheels;
    std::optional<StereoRigParams> stereo;           ///< beside a planar lidar
    double bumps_rad = 0.0;                          ///< of the ground below a spatial lidar, see Terrain
    double gyro_bias_radps = 0.0017453292519943296;  ///< about each axis
    std::size_t people = 0;
    std::size_t cars = 0;              ///< on the scene's road
    std::size_t places = 12;           ///< to visit where the scene has no tour of its own
    std::vector<Point> path;           ///< drive along this instead, if it has two points or more
    std::optional<double> duration_s;  ///< with one of these two the tour is repeated until it is over
    std::optional<double> distance_m;
    std::uint64_t seed = 1;
    std::int64_t start_us = 0;  ///< [us] stamp at which the drive begins
};

struct SimulationResult {
    Pose2 P_world_start;
    std::vector<TimedPose> truth;  ///< true pose at each scan's first beam, see Sweep::truth()
    double simulated_s = 0.0;
    double driven_m = 0.0;
    std::size_t given_up = 0;  ///< places that the robot did not get to
};

/// Runs the simulation. Log lines go to `write` as they come; `progress`, from 0 to 1, is told now and then.
/// Throws InputError where robot, path or start do not fit the scene.
[[nodiscard]] SimulationResult simulate(const Scene& scene, const SimulationParams& params, LogWriter& writer,
                                        const std::function<void(std::string_view)>& write,
                                        const std::function<void(double)>& progress);

}  // namespace crspf::sim
