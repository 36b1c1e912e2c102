#include "drivers/can/motion_decoders.hpp"

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

ImuDecoder::ImuDecoder(const ImuParams& params)
    : speed_(params.speed), yaw_rate_(params.yaw_rate), bias_radps_(params.yaw_rate_bias_radps) {}

std::optional<ImuSample> ImuDecoder::on_frame(const CanFrame& frame, Stamp received) {
    speed_.on_frame(frame, received);
    const std::optional<std::uint64_t> yaw_rate = yaw_rate_.on_frame(frame, received);
    if (!yaw_rate) {
        return std::nullopt;
    }
    if (!speed_.fresh(received)) {
        ++counters_.incomplete;
        return std::nullopt;
    }
    ++counters_.samples;
    return ImuSample{
        .stamp = received, .yaw_rate_radps = yaw_rate_.value(*yaw_rate) - bias_radps_, .speed_mps = speed_.speed_mps()};
}

void ImuDecoder::on_time(Stamp now) {
    speed_.on_time(now);
    yaw_rate_.on_time(now);
}

}  // namespace crspf
