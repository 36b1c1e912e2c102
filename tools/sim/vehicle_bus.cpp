#include "tools/sim/vehicle_bus.hpp"

#include <stdexcept>
#include <utility>

#include "core/base/trig.hpp"
#include "drivers/can/dbc_lookup.hpp"
#include "drivers/can/frame_signal.hpp"

namespace crspf::sim {
namespace {

constexpr std::uint64_t kStream = 9;
// A gyroscope of a few cents, after its bias was taken off at standstill.
constexpr double kGyroBias_radps = 0.1 * kPi / 180.0;
constexpr double kGyroNoise_radps = 0.1 * kPi / 180.0;

FrameSignal signal_of(std::string_view dotted) {
    const std::size_t dot = dotted.find('.');
    const DbcLookup found = find_signal(kVehicleDbc, dotted.substr(0, dot), dotted.substr(dot + 1));
    if (found.status != DbcLookup::Status::kFound) {
        throw std::logic_error("the vehicle's own signals are not in their DBC text");
    }
    return found.signal;
}

void set(CanFrame& frame, std::string_view signal, double value) {
    if (!encode(signal_of(signal).layout, std::span(frame.data).first(frame.length), value)) {
        throw std::logic_error("the vehicle's frames cannot hold their signals");
    }
}

}  // namespace

VehicleBus::VehicleBus(const RobotParams& robot, std::uint64_t seed, Record record)
    : BaseBus(seed, kStream, std::move(record)), wheel_base_m_(robot.wheel_base_m) {}

void VehicleBus::send(Stamp now, const OdometryRecord& odometry) {
    CanFrame motion{.id = signal_of(kSpeedSignal).id, .length = 4};
    set(motion, kSpeedSignal, odometry.speed_mps);
    set(motion, kSteeringSignal, arc_tan2(wheel_base_m_ * odometry.curvature, 1.0));
    put(now, motion);
    CanFrame gyro{.id = signal_of(kYawRateSignal).id, .length = 6};
    set(gyro, kYawRateSignal, odometry.true_turn_rate_radps + kGyroBias_radps + random().normal() * kGyroNoise_radps);
    put(now, gyro);
}

}  // namespace crspf::sim
