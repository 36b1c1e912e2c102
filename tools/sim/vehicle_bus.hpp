// A vehicle that tells its speed and steering, with a gyroscope beside it.
#pragma once

#include <string_view>

#include "drivers/can/can_signal.hpp"
#include "tools/sim/base_bus.hpp"

namespace crspf::sim {

/// Its messages; the gyroscope is that of config/dbc/xsens_mti.dbc.
inline constexpr std::string_view kVehicleDbc =
    "BO_ 416 Motion: 4 VEHICLE\n"
    " SG_ Speed : 0|16@1- (0.001,0) [-32.768|32.767] \"m/s\" Vector__XXX\n"
    " SG_ Steering : 16|16@1- (0.0001,0) [-3.2768|3.2767] \"rad\" Vector__XXX\n"
    "\n"
    "BO_ 50 RateOfTurn: 6 MTI\n"
    " SG_ GyroZ : 39|16@0- (0.001953125,0) [-64|63.998046875] \"rad/s\" Vector__XXX\n";
inline constexpr std::string_view kSpeedSignal = "Motion.Speed";
inline constexpr std::string_view kSteeringSignal = "Motion.Steering";
inline constexpr std::string_view kYawRateSignal = "RateOfTurn.GyroZ";

class VehicleBus final : public BaseBus {
 public:
    VehicleBus(const RobotParams& robot, std::uint64_t seed, Record record);

    void begin(Stamp /*now*/) override {}
    void send(Stamp now, const OdometryRecord& odometry) override;

 private:
    double wheel_base_m_;
};

}  // namespace crspf::sim
