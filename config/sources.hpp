// The robot's sensors: which driver understands each, the port it is at, and what its signals mean.
#pragma once

#include <cstdint>
#include <string>
#include <variant>
#include <vector>

#include "drivers/can/motion_decoders.hpp"
#include "drivers/can/wheel_decoder.hpp"
#include "drivers/scip/scip_params.hpp"
#include "drivers/sick/lms2xx_params.hpp"
#include "drivers/sick/sick_params.hpp"
#include "drivers/velodyne/velodyne_params.hpp"

namespace crspf {

enum class SourceDriver : std::uint8_t { kScip, kSick, kLms2xx, kLd06, kVelodyne, kCan, kMotion };

/// Of kScip, kSick, kLms2xx, kLd06 and kVelodyne, which give scans.
[[nodiscard]] constexpr bool is_lidar(SourceDriver driver) {
    return driver != SourceDriver::kCan && driver != SourceDriver::kMotion;
}

/// What becomes of a revolution of many lasers.
enum class PlanarScan : std::uint8_t { kRing, kObstacles };

struct PortConfig {
    enum class Kind : std::uint8_t { kSerial, kTcp, kUdp, kCan };
    Kind kind = Kind::kSerial;
    std::string device;         ///< kSerial: /dev/...; kCan: the interface
    std::uint32_t address = 0;  ///< kTcp: IPv4 of the sensor; kUdp: our own, 0 for any
    std::uint16_t port = 0;     ///< kTcp, kUdp
};

/// One signal of a CAN bus, as the file names it.
struct SignalConfig {
    std::string role;    ///< of signal_roles()
    std::string signal;  ///< MESSAGE.SIGNAL of the DBC
    double scale = 1.0;
    bool is_speed = false;
    double zero = 0.0;
    double timeout_s = 0.5;
    std::string valid;
    std::uint64_t valid_bits = 1;
    std::string alive;
    std::string direction;
    std::uint64_t backward_bits = 1;
    std::uint64_t modulus = 0;
    bool any_source_address = false;
};

struct CanSourceConfig {
    std::vector<std::string> dbc;  ///< as the file has it
    /// What of the DBC the signals below need, whether it came from files or from this very key.
    std::string dbc_text;
    std::vector<SignalConfig> signals;
    double speed_max_mps = 3.0;
    double pair_within_s = 0.005;
    std::vector<std::uint32_t> canopen_nodes;
    double heartbeat_timeout_s = 1.5;

    /// What the signals together are.
    std::variant<std::monostate, WheelParams, AckermannParams, ImuParams> odometer;
};

struct SourceConfig {
    std::string name;  ///< also in recordings
    SourceDriver driver = SourceDriver::kScip;
    std::string port_text;
    PortConfig port;  ///< port_text, understood
    bool record_only = false;

    // Of these the driver's count; the plain numbers and texts beside a *Params are its, as the file has them.
    ScipParams scip;
    SickParams sick;
    double sick_frequency_hz = 0.0;
    double sick_resolution_rad = 0.0;
    Lms2xxParams lms2xx;
    std::uint32_t lms2xx_angle_deg = 180;
    double lms2xx_resolution_deg = 0.5;
    std::uint32_t lms2xx_value_mask = 0x1FFF;
    VelodyneParams velodyne;
    VelodyneScanParams velodyne_scan;
    PlanarScan velodyne_planar = PlanarScan::kRing;
    std::string velodyne_address = "192.168.1.201";
    int velodyne_laser = -1;
    std::string velodyne_calibration;  ///< db.xml as a path that the process can open; empty: none
    CanSourceConfig can;
};

/// Whole revolutions, in place of scans.
[[nodiscard]] inline bool gives_clouds(const SourceConfig& source) {
    return source.driver == SourceDriver::kVelodyne && source.velodyne_planar == PlanarScan::kObstacles;
}

}  // namespace crspf
