#include "drivers/can/motion_decoders.hpp"

#include <algorithm>

namespace crspf {

HeldSpeed::HeldSpeed(const SpeedBinding& binding) : first_(binding.signal) {
    if (binding.second) {
        second_.emplace(*binding.second);
    }
}

bool HeldSpeed::on_frame(const CanFrame& frame, Stamp received) {
    const std::optional<std::uint64_t> first = first_.on_frame(frame, received);
    if (first) {
        first_mps_ = first_.value(*first);
    }
    const std::optional<std::uint64_t> second = second_ ? second_->on_frame(frame, received) : std::nullopt;
    if (second) {
        second_mps_ = second_->value(*second);
    }
    return first || second;
}

void HeldSpeed::on_time(Stamp now) {
    first_.on_time(now);
    if (second_) {
        second_->on_time(now);
    }
}

AckermannDecoder::AckermannDecoder(const AckermannParams& params)
    : speed_(params.speed), steering_(params.steering), steering_zero_rad_(params.steering_zero_rad) {}

std::optional<AckermannSample> AckermannDecoder::on_frame(const CanFrame& frame, Stamp received) {
    const bool speed = speed_.on_frame(frame, received);
    const std::optional<std::uint64_t> steering = steering_.on_frame(frame, received);
    if (steering) {
        steering_rad_ = steering_.value(*steering) - steering_zero_rad_;
    }
    if (!speed && !steering) {
        return std::nullopt;
    }
    if (!fresh(received)) {
        ++counters_.incomplete;
        return std::nullopt;
    }
    ++counters_.samples;
    return AckermannSample{.stamp = received, .speed_mps = speed_.speed_mps(), .steering_rad = steering_rad_};
}

void AckermannDecoder::on_time(Stamp now) {
    speed_.on_time(now);
    steering_.on_time(now);
}

HeldInertial::HeldInertial(const InertialBinding& binding)
    : signals_{BoundSignal(binding.roll_rate), BoundSignal(binding.pitch_rate), BoundSignal(binding.acceleration_x),
               BoundSignal(binding.acceleration_y), BoundSignal(binding.acceleration_z)} {}

void HeldInertial::on_frame(const CanFrame& frame, Stamp received) {
    const std::array<double*, 5> fields{&value_.roll_rate_radps, &value_.pitch_rate_radps, &value_.acceleration_x_mps2,
                                        &value_.acceleration_y_mps2, &value_.acceleration_z_mps2};
    for (std::size_t i = 0; i < signals_.size(); ++i) {
        if (const auto raw = signals_[i].on_frame(frame, received)) {
            *fields[i] = signals_[i].value(*raw);
        }
    }
}

void HeldInertial::on_time(Stamp now) {
    for (BoundSignal& signal : signals_) {
        signal.on_time(now);
    }
}

bool HeldInertial::fresh(Stamp now) const {
    return std::all_of(signals_.begin(), signals_.end(), [now](const BoundSignal& s) { return s.fresh(now); });
}

ImuDecoder::ImuDecoder(const ImuParams& params) : yaw_rate_(params.yaw_rate), bias_radps_(params.yaw_rate_bias_radps) {
    if (params.speed) {
        speed_.emplace(*params.speed);
    }
    if (params.inertial) {
        inertial_.emplace(*params.inertial);
    }
}

std::optional<ImuSample> ImuDecoder::on_frame(const CanFrame& frame, Stamp received) {
    if (speed_) {
        speed_->on_frame(frame, received);
    }
    if (inertial_) {
        inertial_->on_frame(frame, received);
    }
    const std::optional<std::uint64_t> yaw_rate = yaw_rate_.on_frame(frame, received);
    if (!yaw_rate) {
        return std::nullopt;
    }
    if (speed_ && !speed_->fresh(received)) {
        ++counters_.incomplete;
        return std::nullopt;
    }
    ++counters_.samples;
    ImuSample sample{.stamp = received,
                     .yaw_rate_radps = yaw_rate_.value(*yaw_rate) - bias_radps_,
                     .speed_mps = speed_ ? speed_->speed_mps() : 0.0,
                     .speed_told = speed_.has_value()};
    if (inertial_ && inertial_->fresh(received)) {
        sample.inertial = inertial_->value();
    }
    return sample;
}

void ImuDecoder::on_time(Stamp now) {
    if (speed_) {
        speed_->on_time(now);
    }
    if (inertial_) {
        inertial_->on_time(now);
    }
    yaw_rate_.on_time(now);
}

}  // namespace crspf
