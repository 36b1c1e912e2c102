#include "tools/crspf/sim_config.hpp"

#include <cstdio>
#include <string_view>

#include "core/base/trig.hpp"
#include "tools/sim/kitti_folder.hpp"

namespace crspf::cli {
namespace {

constexpr double kLowest_m = 1.0;  // of what stands in the way

/// The two messages of config/dbc/canopen_402.dbc that the drives send.
constexpr std::string_view kCanopenDbc =
    "BO_ 897 LeftPosition: 6 LEFT\n"
    " SG_ LeftPositionActual : 16|32@1- (1,0) [0|0] \"counts\" Vector__XXX\n"
    "\n"
    "BO_ 898 RightPosition: 6 RIGHT\n"
    " SG_ RightPositionActual : 16|32@1- (1,0) [0|0] \"counts\" Vector__XXX\n";

/// A vehicle's own message; the IMU is that of config/dbc/xsens_mti.dbc.
constexpr std::string_view kVehicleDbc =
    "BO_ 416 Motion: 4 VEHICLE\n"
    " SG_ Speed : 0|16@1- (0.001,0) [-32.768|32.767] \"m/s\" Vector__XXX\n"
    " SG_ Steering : 16|16@1- (0.0001,0) [-3.2768|3.2767] \"rad\" Vector__XXX\n"
    "\n"
    "BO_ 50 RateOfTurn: 6 MTI\n"
    " SG_ GyroX : 7|16@0- (0.001953125,0) [-64|63.998046875] \"rad/s\" Vector__XXX\n"
    " SG_ GyroY : 23|16@0- (0.001953125,0) [-64|63.998046875] \"rad/s\" Vector__XXX\n"
    " SG_ GyroZ : 39|16@0- (0.001953125,0) [-64|63.998046875] \"rad/s\" Vector__XXX\n"
    "\n"
    "BO_ 52 Acceleration: 6 MTI\n"
    " SG_ AccelerationX : 7|16@0- (0.00390625,0) [-128|127.99609375] \"m/s^2\" Vector__XXX\n"
    " SG_ AccelerationY : 23|16@0- (0.00390625,0) [-128|127.99609375] \"m/s^2\" Vector__XXX\n"
    " SG_ AccelerationZ : 39|16@0- (0.00390625,0) [-128|127.99609375] \"m/s^2\" Vector__XXX\n";

/// Which driver listens to which source of the capture, and what the base's signals mean.
std::string sources_of(const sim::SimulationParams& params) {
    std::string text = "\n[source.lidar]\n";
    if (params.lidar.spatial()) {
        text +=
            "driver = \"velodyne\"\n"
            "port = \"udp://:2368\"\n"
            "address = \"192.168.1.201\"\n";
        text += params.lidar.velodyne == VelodyneModel::kHdl32e ? "model = \"HDL-32E\"\n" : "model = \"VLP-16\"\n";
        // A ring tilts with the vehicle, and from a roof it looks over what is low.
        const bool ring_sees_all = params.bumps_rad <= 0.0 && params.robot.lidar_height_m < kLowest_m;
        text += ring_sees_all ? "" : "planar = \"obstacles\"\n";
    } else if (params.lidar.driver == SourceDriver::kSick) {
        text +=
            "driver = \"sick\"\n"
            "port = \"tcp://192.168.0.1:2112\"\n";
    } else {
        text +=
            "driver = \"scip\"\n"
            "port = \"/dev/ttyACM0\"\n";
    }
    const bool wheels = params.odometer == sim::Odometer::kWheels;
    text +=
        "\n[source.base]\n"
        "driver = \"can\"\n"
        "port = \"can0\"\n";
    text += wheels ? "canopen_nodes = [1, 2]\n" : "";
    text += "dbc_text = \"\"\"\n";
    text += wheels ? kCanopenDbc : kVehicleDbc;
    // Quotes need no escape within three of them.
    text += "\"\"\"\n";
    const auto add_signal = [&](const char* role, const char* signal) {
        text += std::string("\n[source.base.") + role + "]\nsignal = \"" + signal + "\"\n";
    };
    if (wheels) {
        char scale[64];
        std::snprintf(scale, sizeof scale, "scale = %.12e  # metres per count\n", params.robot.metres_per_count());
        add_signal("left", "LeftPosition.LeftPositionActual");
        text += scale;
        add_signal("right", "RightPosition.RightPositionActual");
        text += scale;
    } else {
        const bool tells_speed = params.odometer == sim::Odometer::kImu || params.odometer == sim::Odometer::kSteering;
        if (tells_speed) {
            add_signal("speed", "Motion.Speed");
        }
        if (params.odometer == sim::Odometer::kSteering) {
            add_signal("steering", "Motion.Steering");
        } else {
            add_signal("yaw_rate", "RateOfTurn.GyroZ");
        }
        if (params.odometer == sim::Odometer::kImu || params.odometer == sim::Odometer::kInertial) {
            add_signal("roll_rate", "RateOfTurn.GyroX");
            add_signal("pitch_rate", "RateOfTurn.GyroY");
            add_signal("acceleration_x", "Acceleration.AccelerationX");
            add_signal("acceleration_y", "Acceleration.AccelerationY");
            add_signal("acceleration_z", "Acceleration.AccelerationZ");
        }
    }
    return text;
}

std::string stereo_of(const sim::StereoRigParams& stereo) {
    const CameraMounting& mounting = stereo.camera.mounting;
    char text[2048];
    std::snprintf(text, sizeof text,
                  "\n"
                  "[stereo]\n"
                  "device = \"/dev/video0\"\n"
                  "width_px = %d\n"
                  "height_px = %d\n"
                  "rate_hz = %.6f\n"
                  "calibration_text = \"\"\"\n%s\"\"\"\n"
                  "x_m = %.6f\n"
                  "y_m = %.6f\n"
                  "z_m = %.6f\n"
                  "yaw_deg = %.6f\n",
                  stereo.camera.camera.width, stereo.camera.camera.height, stereo.rate_hz,
                  sim::kitti_calibration(stereo.camera.camera).c_str(), mounting.x_m, mounting.y_m, mounting.z_m,
                  degrees(mounting.yaw_rad));
    return text;
}

}  // namespace

std::string sim_config(const sim::SimulationParams& params, bool dat_log, bool capture) {
    // The reader takes a .dat line for written 0.18 s after its scan's first beam, as the real logger's are; ours is
    // not.
    const double stamp_offset_s = dat_log ? 0.18 : 0.0;
    char text[1024];
    std::snprintf(text, sizeof text,
                  "# What the simulated robot's maker would tell.\n"
                  "[lidar]\n"
                  "x_m = %.6f\n"
                  "y_m = %.6f\n"
                  "yaw_deg = %.6f\n"
                  "range_min_m = %.6f\n"
                  "range_max_m = %.6f\n"
                  "time_per_beam_s = %.12f\n"
                  "stamp_offset_s = %.6f\n"
                  "\n"
                  "[odometry]\n"
                  "wheel_span_m = %.6f\n"
                  "wheel_base_m = %.6f\n"
                  "\n"
                  "[map]\n"
                  "resolution_m = %.6f\n"
                  "\n"
                  "[wheels]\n"
                  "counts_per_turn = %.6f\n"
                  "wheel_radius_m = %.6f\n",
                  params.P_base_lidar.x_m, params.P_base_lidar.y_m, degrees(params.P_base_lidar.theta_rad),
                  params.lidar.range_min_m, params.lidar.range_max_m,
                  params.lidar.spatial() ? 0.0 : params.lidar.time_per_beam_s(), stamp_offset_s,
                  params.robot.wheel_span_m, params.robot.wheel_base_m, params.robot.map_resolution_m,
                  params.robot.counts_per_turn, params.robot.wheel_radius_m);
    std::string config = text;
    if (params.lidar.spatial()) {
        std::snprintf(text, sizeof text,
                      "\n"
                      "[obstacles]\n"
                      "lidar_height_m = %.6f\n"
                      "vehicle_height_m = %.6f\n"
                      "range_max_m = %.6f\n",
                      params.robot.lidar_height_m, params.robot.height_m, params.robot.obstacle_range_m);
        config += text;
    }
    config += params.stereo ? stereo_of(*params.stereo) : "";
    return capture ? config + sources_of(params) : config;
}

}  // namespace crspf::cli
