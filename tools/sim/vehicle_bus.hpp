// A vehicle that tells its speed and steering, with an IMU beside it; or the IMU alone.
#pragma once

#include <string_view>

#include "drivers/can/can_signal.hpp"
#include "tools/sim/base_bus.hpp"
#include "tools/sim/simulation.hpp"

namespace crspf::sim {

/// Its messages; the IMU is that of config/dbc/xsens_mti.dbc.
inline constexpr std::string_view kVehicleDbc =
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
inline constexpr std::string_view kSpeedSignal = "Motion.Speed";
inline constexpr std::string_view kSteeringSignal = "Motion.Steering";
inline constexpr std::string_view kRollRateSignal = "RateOfTurn.GyroX";
inline constexpr std::string_view kPitchRateSignal = "RateOfTurn.GyroY";
inline constexpr std::string_view kYawRateSignal = "RateOfTurn.GyroZ";
inline constexpr std::string_view kAccelerationXSignal = "Acceleration.AccelerationX";
inline constexpr std::string_view kAccelerationYSignal = "Acceleration.AccelerationY";
inline constexpr std::string_view kAccelerationZSignal = "Acceleration.AccelerationZ";

class VehicleBus final : public BaseBus {
 public:
    VehicleBus(const SimulationParams& params, Record record);

    void begin(Stamp /*now*/) override {}
    void send(Stamp now, const OdometryRecord& odometry) override;

 private:
    void send_motion(Stamp now, const OdometryRecord& odometry);

    double wheel_base_m_;
    double gyro_bias_radps_;
    bool tells_speed_;
};

}  // namespace crspf::sim
