#include "tools/sim/vehicle_bus.hpp"

#include <stdexcept>
#include <utility>

#include "core/base/trig.hpp"
#include "drivers/can/frame_signal.hpp"

namespace crspf::sim {
namespace {

// A gyroscope of a few cents, after its bias was taken off at standstill.
constexpr double kGyroBias_radps = 0.1 * kPi / 180.0;
constexpr double kGyroNoise_radps = 0.1 * kPi / 180.0;

void set(CanFrame& frame, std::string_view signal, double value) {
    if (!encode(signal_of(kVehicleDbc, signal).layout, std::span(frame.data).first(frame.length), value)) {
        throw std::logic_error("the vehicle's frames cannot hold their signals");
    }
}

}  // namespace

VehicleBus::VehicleBus(const RobotParams& robot, std::uint64_t seed, Record record)
    : BaseBus(seed, RandomStream::kVehicle, std::move(record)), wheel_base_m_(robot.wheel_base_m) {}

void VehicleBus::send(Stamp now, const OdometryRecord& odometry) {
    CanFrame motion{.id = signal_of(kVehicleDbc, kSpeedSignal).id, .length = 4};
    set(motion, kSpeedSignal, odometry.speed_mps);
    set(motion, kSteeringSignal, arc_tan2(wheel_base_m_ * odometry.curvature, 1.0));
    put(now, motion);
    CanFrame gyro{.id = signal_of(kVehicleDbc, kYawRateSignal).id, .length = 6};
    set(gyro, kYawRateSignal, odometry.true_turn_rate_radps + kGyroBias_radps + random().normal() * kGyroNoise_radps);
    put(now, gyro);
}

}  // namespace crspf::sim
