#include "drivers/can/wheel_decoder.hpp"

#include <algorithm>
#include <cmath>  // abs

namespace crspf {
namespace {

/// How many values the wheel's counter has. 0 stands for 2^64.
std::uint64_t modulus_of(const WheelBinding& wheel) {
    const unsigned length = wheel.signal.signal.layout.length;
    if (wheel.modulus != 0 || length >= 64) {
        return wheel.modulus;
    }
    return std::uint64_t{1} << length;
}

/// [m] for each value of the counter, with its sign.
double metres_per_count(const WheelBinding& wheel) {
    return wheel.signal.signal.layout.factor * wheel.signal.scale;
}

/// [m] once round the counter.
double round_m(const WheelBinding& wheel) {
    const std::uint64_t modulus = modulus_of(wheel);
    return std::abs(metres_per_count(wheel)) * (modulus == 0 ? 18446744073709551616.0 : static_cast<double>(modulus));
}

}  // namespace

bool unambiguous(const WheelBinding& wheel, double speed_max_mps) {
    const SignalType type = wheel.signal.signal.layout.type;
    const bool counts = type == SignalType::kSigned || type == SignalType::kUnsigned;
    return wheel.is_speed || (counts && speed_max_mps * 2.0 * wheel.signal.timeout.seconds() < round_m(wheel) / 2.0);
}

WheelDecoder::Wheel::Wheel(const WheelBinding& from) : binding(from), signal(from.signal), modulus(modulus_of(from)) {}

WheelDecoder::WheelDecoder(const WheelParams& params) : params_(params), left_(params.left), right_(params.right) {}

/// The way since the value before; nothing where it is not known.
std::optional<double> WheelDecoder::rolled(Wheel& wheel, std::uint64_t raw, double direction, double dt_s) {
    // Adapters deliver in bursts: a frame's way may be that of a whole timeout, whatever its reception says.
    const double furthest_m = params_.speed_max_mps * (std::max(dt_s, 0.0) + wheel.signal.binding().timeout.seconds());
    double distance_m = 0.0;
    if (wheel.binding.is_speed) {
        if (dt_s > wheel.signal.binding().timeout.seconds()) {
            ++counters_.restarts;
            return std::nullopt;
        }
        distance_m = direction * (wheel.signal.value(wheel.raw) + wheel.signal.value(raw)) / 2.0 * dt_s;
    } else {
        if (furthest_m >= round_m(wheel.binding) / 2.0) {
            ++counters_.restarts;
            return std::nullopt;
        }
        distance_m =
            direction * metres_per_count(wheel.binding) * static_cast<double>(counted(wheel.raw, raw, wheel.modulus));
    }
    if (std::abs(distance_m) > furthest_m) {
        ++counters_.jumps;
        return std::nullopt;
    }
    return distance_m;
}

/// One wheel's way is lost: the other's of the same time would be a turn. What it has told of that time is dropped, and
/// where it has yet to tell it, its next value is a beginning.
void WheelDecoder::forget() {
    for (Wheel* each : {&left_, &right_}) {
        each->known = each->waiting;
        each->pending_m = 0.0;
        each->waiting = false;
    }
}

/// Whether the frame told something about the wheel.
bool WheelDecoder::on_wheel(Wheel& wheel, const CanFrame& frame, Stamp received) {
    std::optional<std::uint64_t> raw = wheel.signal.on_frame(frame, received);
    if (!raw) {
        return false;
    }
    const bool backward =
        wheel.binding.direction && bits_in(*wheel.binding.direction, frame) == wheel.binding.backward_bits;
    if (wheel.modulus != 0 && !wheel.binding.is_speed) {
        *raw %= wheel.modulus;
    }
    bool told = false;
    if (wheel.known) {
        const std::optional<double> distance_m =
            rolled(wheel, *raw, backward ? -1.0 : 1.0, (received - wheel.stamp).seconds());
        told = distance_m.has_value();
        if (told) {
            wheel.pending_m += *distance_m;
        } else {
            forget();
        }
    }
    counters_.unpaired += wheel.waiting ? 1U : 0U;
    wheel.waiting = told;
    wheel.known = true;
    wheel.raw = *raw;
    wheel.stamp = received;
    return true;
}

std::optional<DifferentialSample> WheelDecoder::on_frame(const CanFrame& frame, Stamp received) {
    const bool left_spoke = on_wheel(left_, frame, received);
    const bool right_spoke = on_wheel(right_, frame, received);
    if (!left_spoke && !right_spoke) {
        return std::nullopt;
    }
    if (!left_.waiting || !right_.waiting) {
        return std::nullopt;
    }
    Wheel& earlier = left_.stamp < right_.stamp ? left_ : right_;
    if (received - earlier.stamp > params_.pair_within) {
        ++counters_.unpaired;
        earlier.waiting = false;
        return std::nullopt;
    }
    const DifferentialSample sample{.stamp = received, .left_m = left_.pending_m, .right_m = right_.pending_m};
    for (Wheel* each : {&left_, &right_}) {
        each->pending_m = 0.0;
        each->waiting = false;
    }
    ++counters_.samples;
    return sample;
}

void WheelDecoder::on_time(Stamp now) {
    left_.signal.on_time(now);
    right_.signal.on_time(now);
}

}  // namespace crspf
