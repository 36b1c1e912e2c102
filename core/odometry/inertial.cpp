#include "core/odometry/inertial.hpp"

#include <algorithm>

#include "core/base/real.hpp"
#include "core/base/trig.hpp"

namespace crspf {
namespace {

constexpr double kGravity = 9.80665;  // [m/s^2]
constexpr Duration kLongestGap{200'000'000};
constexpr std::uint32_t kStuck = 20;
/// Wheels tell speed in steps: it is smoothed before it is differentiated.
constexpr double kSpeed_s = 0.1;
/// [m/s^2] Bumps and blows: a force that differs from gravity by this counts half.
constexpr double kRough = 1.0;
/// [1/s^2] Bias from what the pull has to do; a bias that changes within minutes, or is told at the start, is followed.
constexpr double kBiasPull = 0.02;
// No sensor on a vehicle measures more; what says so is damaged, and its squares might not be finite.
constexpr double kRateMax_radps = 100.0;
constexpr double kForceMax = 1000.0;  // [m/s^2]
constexpr double kSpeedMax_mps = 1000.0;

bool same(const Inertial& a, const Inertial& b) {
    return a.roll_rate_radps == b.roll_rate_radps && a.pitch_rate_radps == b.pitch_rate_radps &&
           a.acceleration_x_mps2 == b.acceleration_x_mps2 && a.acceleration_y_mps2 == b.acceleration_y_mps2 &&
           a.acceleration_z_mps2 == b.acceleration_z_mps2;
}

}  // namespace

ImuSample InertialFilter::add(const ImuSample& sample) {
    ++counters_.samples;
    forward_mps2_.reset();
    if (!is_usable(sample)) {
        return {.stamp = sample.stamp, .yaw_rate_radps = sample.yaw_rate_radps, .speed_mps = sample.speed_mps};
    }
    const Inertial& inertial = *sample.inertial;
    const Vector3 rate_radps =
        Vector3{.x = inertial.roll_rate_radps, .y = inertial.pitch_rate_radps, .z = sample.yaw_rate_radps} -
        bias_radps_;
    const Vector3 force_mps2{
        .x = inertial.acceleration_x_mps2, .y = inertial.acceleration_y_mps2, .z = inertial.acceleration_z_mps2};
    const Duration since = sample.stamp - stamp_;
    if (started_ && since.ns <= 0) {
        return in_plane(sample, rate_radps, up_);
    }
    const bool gap = since > kLongestGap;
    counters_.gaps += started_ && gap ? 1U : 0U;
    if (!started_ || gap) {
        known_s_ = 0.0;
        standing_ = {};
        speed_mps_ = sample.speed_mps;
        acceleration_mps2_ = 0.0;
        const double force = length(force_mps2);
        up_ = force > 0.5 * kGravity ? (1.0 / force) * force_mps2 : kLevel;
    } else {
        const double dt_s = since.seconds();
        turn(0.5 * (rate_radps_ + rate_radps), dt_s);
        pull(force_mps2, rate_radps, sample, dt_s);
    }
    started_ = true;
    stamp_ = sample.stamp;
    rate_radps_ = rate_radps;
    attitude_.add(sample.stamp, up_);
    forward_mps2_ = force_mps2.x - kGravity * up_.x;
    return in_plane(sample, rate_radps, up_);
}

bool InertialFilter::is_usable(const ImuSample& sample) {
    const Inertial& i = *sample.inertial;
    const auto within = [](double limit, auto... values) { return ((absolute(values) <= limit) && ...); };  // nor NaN
    if (!within(kRateMax_radps, sample.yaw_rate_radps, i.roll_rate_radps, i.pitch_rate_radps) ||
        !within(kSpeedMax_mps, sample.speed_mps) ||
        !within(kForceMax, i.acceleration_x_mps2, i.acceleration_y_mps2, i.acceleration_z_mps2)) {
        ++counters_.damaged;
        return false;
    }
    same_ = started_ && same(raw_, i) ? same_ + 1 : 0;
    raw_ = i;
    const bool stuck =
        same_ >= kStuck && sample.speed_told && !Standing::is_still(sample.speed_mps);  // standing, a coarse one may
    counters_.stuck += stuck ? 1U : 0U;
    return !stuck;
}

/// The vehicle turns, up stays: in its axes up turns back. Second order, for samples 0.1 s apart, too.
void InertialFilter::turn(const Vector3& rate_radps, double dt_s) {
    const Vector3 first = cross(up_, rate_radps);
    const Vector3 second = cross(first, rate_radps);
    up_ = up_ + dt_s * first + (0.5 * dt_s * dt_s) * second;
    up_ = (1.0 / length(up_)) * up_;
}

void InertialFilter::pull(const Vector3& force_mps2, const Vector3& rate_radps, const ImuSample& sample, double dt_s) {
    const double speed_mps = sample.speed_mps;
    const double share = dt_s / (kSpeed_s + dt_s);
    const double before_mps = speed_mps_;
    speed_mps_ += share * (speed_mps - speed_mps_);
    acceleration_mps2_ += share * ((speed_mps_ - before_mps) / dt_s - acceleration_mps2_);
    // What driving causes: the change of the speed's amount and, by turning, of its direction.
    const Vector3 driving_mps2{.x = acceleration_mps2_, .y = rate_radps.z * speed_mps, .z = -rate_radps.y * speed_mps};
    const Vector3 gravity_mps2 = force_mps2 - driving_mps2;
    const double amount_mps2 = length(gravity_mps2);
    if (!(amount_mps2 > 0.5 * kGravity)) {
        return;  // it falls, or the sensor is dead
    }
    const double weight = 1.0 / (1.0 + square((amount_mps2 - kGravity) / kRough));
    known_s_ = std::min(known_s_ + dt_s, kPull_s);
    const Vector3 seen = (1.0 / amount_mps2) * gravity_mps2;
    const Vector3 off = cross(seen, up_);  // about which the vehicle seems to have turned too far
    up_ = up_ + (weight * std::min(dt_s / known_s_, 1.0)) * cross(up_, off);
    up_ = (1.0 / length(up_)) * up_;

    standing_.add(sample.speed_told && Standing::is_still(speed_mps) && Standing::is_still_turn(rate_radps.x) &&
                      Standing::is_still_turn(rate_radps.y) && absolute(rate_radps.z) < kGyroBiasMax_radps,
                  dt_s);
    Vector3 change;
    if (standing_.is_settled()) {
        change = Standing::bias_share(dt_s) * rate_radps;
    } else if (known_s_ >= kPull_s) {
        change = (-kBiasPull * weight * dt_s) * off;
    }
    bias_radps_ = {
        .x = clamped_gyro_bias(bias_radps_.x + change.x), .y = clamped_gyro_bias(bias_radps_.y + change.y), .z = 0.0};
}

ImuSample InertialFilter::in_plane(const ImuSample& sample, const Vector3& rate_radps, const Vector3& up) {
    // Heading, pitch, roll about z, y, x in turn: up is (-sin pitch, cos pitch sin roll, cos pitch cos roll).
    const double across = square(up.y) + square(up.z);
    if (!(across > 0.25)) {
        return {.stamp = sample.stamp, .yaw_rate_radps = sample.yaw_rate_radps, .speed_mps = sample.speed_mps};
    }
    return {.stamp = sample.stamp,
            .yaw_rate_radps = (rate_radps.y * up.y + rate_radps.z * up.z) / across,
            .speed_mps = sample.speed_mps * square_root(across)};
}

}  // namespace crspf
