#include "tools/sim/base_bus.hpp"

#include <algorithm>
#include <utility>
#include <variant>
#include <vector>

#include "core/base/trig.hpp"
#include "drivers/can/canopen.hpp"

namespace crspf::sim {
namespace {

constexpr Duration kFrame{110'000};        // on a bus of 1 Mbit/s
constexpr double kDelayMean_ns = 200'000;  // from there to the host's stamp
constexpr Duration kHeartbeat{500'000'000};

// An IMU of a few cents.
constexpr double kGyroNoise_radps = 0.1 * kPi / 180.0;
constexpr double kForceBias = 0.05;  // [m/s^2]
constexpr double kForceNoise = 0.1;  // [m/s^2]

void append(std::vector<SignalBinding>& out, const SpeedBinding& speed) {
    out.push_back(speed.signal);
    if (speed.second) {
        out.push_back(*speed.second);
    }
}

std::vector<SignalBinding> bindings_of(const CanSourceConfig& bus) {
    std::vector<SignalBinding> out;
    if (const auto* wheels = std::get_if<WheelParams>(&bus.odometer)) {
        out = {wheels->left.signal, wheels->right.signal};
    } else if (const auto* car = std::get_if<AckermannParams>(&bus.odometer)) {
        append(out, car->speed);
        out.push_back(car->steering);
    } else if (const auto* imu = std::get_if<ImuParams>(&bus.odometer)) {
        if (imu->speed) {
            append(out, *imu->speed);
        }
        out.push_back(imu->yaw_rate);
        if (imu->inertial) {
            out.insert(out.end(), {imu->inertial->roll_rate, imu->inertial->pitch_rate, imu->inertial->acceleration_x,
                                   imu->inertial->acceleration_y, imu->inertial->acceleration_z});
        }
    }
    return out;
}

CanFrame heartbeat(std::uint32_t node) {
    CanFrame frame{.id = 0x700U + node, .length = 1};
    frame.data[0] = static_cast<std::uint8_t>(NodeState::kOperational);
    return frame;
}

/// A vector of the vehicle's axes as its IMU sees it, which is turned by Rz(yaw) Ry(pitch) Rx(roll).
Vector3 seen_by_imu(Vector3 v, const OdometryParams& vehicle) {
    const SinCos yaw = sin_cos(vehicle.imu_yaw_rad);
    v = {.x = yaw.cos * v.x + yaw.sin * v.y, .y = yaw.cos * v.y - yaw.sin * v.x, .z = v.z};
    const SinCos pitch = sin_cos(vehicle.imu_pitch_rad);
    v = {.x = pitch.cos * v.x - pitch.sin * v.z, .y = v.y, .z = pitch.cos * v.z + pitch.sin * v.x};
    const SinCos roll = sin_cos(vehicle.imu_roll_rad);
    return {.x = v.x, .y = roll.cos * v.y + roll.sin * v.z, .z = roll.cos * v.z - roll.sin * v.y};
}

}  // namespace

BaseBus::BaseBus(const CanSourceConfig& bus, const OdometryParams& vehicle, const SimulationParams& params,
                 Record record)
    : bus_(bus),
      vehicle_(vehicle),
      robot_(params.robot),
      gyro_bias_radps_(params.gyro_bias_radps),
      record_(std::move(record)),
      delays_(params.seed, RandomStream::kBase),
      noise_(params.seed, RandomStream::kImu),
      frames_(bus.dbc_text, bindings_of(bus)) {
    if (const auto* wheels = std::get_if<WheelParams>(&bus_.odometer)) {
        left_.emplace(wheels->left);
        right_.emplace(wheels->right);
    }
}

void BaseBus::send(Stamp now, const OdometryRecord& odometry) {
    for (; !bus_.canopen_nodes.empty() && next_heartbeat_ <= now; next_heartbeat_ = next_heartbeat_ + kHeartbeat) {
        for (const std::uint32_t node : bus_.canopen_nodes) {
            put(next_heartbeat_, heartbeat(node));
        }
    }
    std::visit([&](const auto& odometer) { set(odometer, odometry); }, bus_.odometer);
    frames_.send([&](const CanFrame& frame) { put(now, frame); });
}

void BaseBus::set(const WheelParams& /*wheels*/, const OdometryRecord& odometry) {
    const double metres_per_count = robot_.metres_per_count();
    const double turn_mps = odometry.turn_rate_radps * robot_.wheel_span_m / 2.0;
    const auto tell = [&](WheelSignal& wheel, std::int64_t counts, double speed_mps, double factor) {
        wheel.tell(static_cast<double>(counts) * metres_per_count / factor, speed_mps / factor, frames_);
    };
    tell(*left_, odometry.counts.left, odometry.speed_mps - turn_mps, vehicle_.left_wheel_factor);
    tell(*right_, odometry.counts.right, odometry.speed_mps + turn_mps, vehicle_.right_wheel_factor);
}

void BaseBus::set_speed(const SpeedBinding& speed, const OdometryRecord& odometry) {
    const double told_mps = odometry.speed_mps / vehicle_.speed_factor;
    frames_.set(speed.signal, told_mps);
    if (speed.second) {
        frames_.set(*speed.second, told_mps);
    }
}

void BaseBus::set(const AckermannParams& car, const OdometryRecord& odometry) {
    const double steering_rad = arc_tan2(robot_.wheel_base_m * odometry.curvature, 1.0);
    OdometryRecord told = odometry;
    if (vehicle_.front_driven) {
        told.speed_mps /= sin_cos(steering_rad).cos;
    }
    set_speed(car.speed, told);
    frames_.set(car.steering, steering_rad - vehicle_.steering_offset_rad + car.steering_zero_rad);
}

void BaseBus::set(const ImuParams& imu, const OdometryRecord& odometry) {
    if (imu.speed) {
        set_speed(*imu.speed, odometry);
    }
    const Vector3 rate_radps = seen_by_imu(odometry.imu.rate_radps, vehicle_);
    const Vector3 force_mps2 = seen_by_imu(odometry.imu.force_mps2, vehicle_);
    const auto rate = [&](const SignalBinding& axis, double true_radps) {
        frames_.set(axis, true_radps + gyro_bias_radps_ + noise_.normal() * kGyroNoise_radps);
    };
    const auto force = [&](const SignalBinding& axis, double true_mps2) {
        frames_.set(axis, true_mps2 + kForceBias + noise_.normal() * kForceNoise);
    };
    rate(imu.yaw_rate, rate_radps.z + imu.yaw_rate_bias_radps + vehicle_.yaw_rate_bias_radps);
    if (imu.inertial) {
        rate(imu.inertial->roll_rate, rate_radps.x);
        rate(imu.inertial->pitch_rate, rate_radps.y);
        force(imu.inertial->acceleration_x, force_mps2.x);
        force(imu.inertial->acceleration_y, force_mps2.y);
        force(imu.inertial->acceleration_z, force_mps2.z);
    }
}

void BaseBus::put(Stamp now, const CanFrame& frame) {
    const Duration delay{static_cast<std::int64_t>(kDelayMean_ns * delays_.exponential())};
    last_ = std::max(last_ + kFrame, now + kFrame + delay);
    record_(last_, frame);
}

}  // namespace crspf::sim
