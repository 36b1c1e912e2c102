#include "drivers/motion/motion_decoder.hpp"

#include "core/base/real.hpp"

namespace crspf {
namespace {

constexpr double kLargestStep_m = 10.0;      // as the odometry has it
constexpr double kLargestHeading_rad = 1e6;  // as trigonometry has it
constexpr std::uint32_t kHalfRound = 0x80000000U;

}  // namespace

bool MotionDecoder::usable(const MotionDatagram& datagram) {
    const Pose2& P = datagram.P_odom_base;
    if (!is_finite(P.x_m) || !is_finite(P.y_m) || !(absolute(P.theta_rad) <= kLargestHeading_rad) ||
        !is_finite(datagram.translation_variance_m2) || !is_finite(datagram.rotation_variance_rad2)) {
        ++counters_.not_finite;
        return false;
    }
    if (datagram.age < Duration{} || datagram.age > kMotionAgeMax) {
        ++counters_.bad_age;
        return false;
    }
    return true;
}

void MotionDecoder::move(const MotionDatagram& to, MotionSample& sample) {
    const Pose2 step = inverse(before_->P_odom_base) * to.P_odom_base;
    const double squared_m2 = square(step.x_m) + square(step.y_m);
    const double variance_m2 = to.translation_variance_m2 - before_->translation_variance_m2;
    const double variance_rad2 = to.rotation_variance_rad2 - before_->rotation_variance_rad2;
    if (!(squared_m2 <= square(kLargestStep_m)) || variance_m2 < 0.0 || variance_rad2 < 0.0) {  // nor NaN
        ++counters_.implausible;
        return;
    }
    sample.P_previous_base = step;
    sample.translation_variance_m2 = variance_m2;
    sample.rotation_variance_rad2 = variance_rad2;
}

std::optional<MotionSample> MotionDecoder::on_datagram(std::span<const std::uint8_t> payload, Stamp received) {
    MotionDatagram datagram;
    switch (decode(payload, datagram)) {
        case MotionFault::kNone: break;
        case MotionFault::kLength: ++counters_.bad_length; return std::nullopt;
        case MotionFault::kMagic: ++counters_.bad_magic; return std::nullopt;
        case MotionFault::kVersion: ++counters_.bad_version; return std::nullopt;
        case MotionFault::kCrc: ++counters_.bad_crc; return std::nullopt;
    }
    if (!usable(datagram)) {
        return std::nullopt;
    }
    MotionSample sample;
    sample.stamp = {received.ns - datagram.age.ns};
    sample.blind = datagram.blind;
    if (before_ && before_->session == datagram.session) {
        const std::uint32_t ahead = datagram.sequence - before_->sequence;
        if (ahead == 0 || ahead >= kHalfRound || sample.stamp <= stamp_) {
            ++counters_.ran_back;
            return std::nullopt;
        }
        counters_.lost += ahead - 1;
        move(datagram, sample);
    } else {
        counters_.restarts += before_ ? 1U : 0U;
    }
    before_ = datagram;
    stamp_ = sample.stamp;
    if (!sample.blind) {
        blind_since_.reset();
    } else if (!blind_since_) {
        blind_since_ = sample.stamp;
    }
    ++counters_.samples;
    counters_.blind += sample.blind ? 1 : 0;
    return sample;
}

}  // namespace crspf
