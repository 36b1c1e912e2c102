#include "platform/crspfd/odometry_module.hpp"

#include <algorithm>
#include <variant>

namespace crspf {

namespace {

/// Over which the speed is taken: a few samples of an encoder, less than a manoeuvre.
constexpr Duration kSpeedInterval{50'000'000};

}  // namespace

bool OdometryModule::turn(Stamp now) {
    const bool corrected = take_corrections();
    const bool moved = take_motions(now);
    if (corrected || moved) {
        publish();
    }
    return moved;
}

bool OdometryModule::take_corrections() {
    bool any = false;
    Correction correction;
    while (exchange_.corrections.pop(correction)) {
        odometry_.correct(correction.stamp, correction.P_map_base);
        state_.jumps = static_cast<std::uint8_t>(state_.jumps + (correction.jump ? 1 : 0));
        any = true;
    }
    return any;
}

bool OdometryModule::take_motions(Stamp now) {
    bool any = false;
    while (const Motion* const motion = exchange_.motions.front()) {
        std::visit(
            [this](const auto& sample) {
                odometry_.add(sample);
                state_.stamp = std::max(state_.stamp, sample.stamp);
            },
            motion->sample);
        const auto* const told = std::get_if<MotionSample>(&motion->sample);
        if (told == nullptr || !told->blind) {
            state_.blind_since = {};
        } else if (state_.blind_since == Stamp{}) {
            state_.blind_since = told->stamp;
        }
        state_.latency = now - motion->received;
        static_cast<void>(exchange_.motions_to_filter.push(*motion));  // the ring counts what does not fit
        exchange_.motions.pop();
        any = true;
    }
    return any;
}

void OdometryModule::publish() {
    const MotionPrior moved = odometry_.motion_between(state_.stamp - kSpeedInterval, state_.stamp);
    state_.speed_mps = moved.P_from_to.x_m / kSpeedInterval.seconds();
    state_.yaw_rate_radps = moved.P_from_to.theta_rad / kSpeedInterval.seconds();
    state_.P_map_odom = odometry_.P_map_odom();
    state_.P_odom_base = inverse(state_.P_map_odom) * odometry_.pose();
    state_.counters = odometry_.counters();
    exchange_.odometry.publish(state_);
}

}  // namespace crspf
