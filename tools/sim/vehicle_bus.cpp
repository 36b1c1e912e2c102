#include "tools/sim/vehicle_bus.hpp"

#include <stdexcept>
#include <utility>

#include "core/base/trig.hpp"
#include "drivers/can/frame_signal.hpp"

namespace crspf::sim {
namespace {

// An IMU of a few cents.
constexpr double kGyroNoise_radps = 0.1 * kPi / 180.0;
constexpr double kForceBias_mps2 = 0.05;
constexpr double kForceNoise_mps2 = 0.1;

void set(CanFrame& frame, std::string_view signal, double value) {
    if (!encode(signal_of(kVehicleDbc, signal).layout, std::span(frame.data).first(frame.length), value)) {
        throw std::logic_error("the vehicle's frames cannot hold their signals");
    }
}

}  // namespace

VehicleBus::VehicleBus(const SimulationParams& params, Record record)
    : BaseBus(params.seed, RandomStream::kVehicle, std::move(record)),
      wheel_base_m_(params.robot.wheel_base_m),
      gyro_bias_radps_(params.gyro_bias_radps),
      tells_speed_(params.odometer == Odometer::kImu || params.odometer == Odometer::kSteering) {}

void VehicleBus::send(Stamp now, const OdometryRecord& odometry) {
    if (tells_speed_) {
        send_motion(now, odometry);
    }
    CanFrame gyro{.id = signal_of(kVehicleDbc, kYawRateSignal).id, .length = 6};
    const auto rate = [&](std::string_view signal, double true_radps) {
        set(gyro, signal, true_radps + gyro_bias_radps_ + random().normal() * kGyroNoise_radps);
    };
    rate(kYawRateSignal, odometry.imu.rate_radps.z);
    rate(kRollRateSignal, odometry.imu.rate_radps.x);
    rate(kPitchRateSignal, odometry.imu.rate_radps.y);
    put(now, gyro);
    CanFrame accelerations{.id = signal_of(kVehicleDbc, kAccelerationXSignal).id, .length = 6};
    const auto force = [&](std::string_view signal, double true_mps2) {
        set(accelerations, signal, true_mps2 + kForceBias_mps2 + random().normal() * kForceNoise_mps2);
    };
    force(kAccelerationXSignal, odometry.imu.force_mps2.x);
    force(kAccelerationYSignal, odometry.imu.force_mps2.y);
    force(kAccelerationZSignal, odometry.imu.force_mps2.z);
    put(now, accelerations);
}

void VehicleBus::send_motion(Stamp now, const OdometryRecord& odometry) {
    CanFrame motion{.id = signal_of(kVehicleDbc, kSpeedSignal).id, .length = 4};
    set(motion, kSpeedSignal, odometry.speed_mps);
    set(motion, kSteeringSignal, arc_tan2(wheel_base_m_ * odometry.curvature, 1.0));
    put(now, motion);
}

}  // namespace crspf::sim
