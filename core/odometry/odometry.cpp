#include "core/odometry/odometry.hpp"

#include <algorithm>
#include <utility>

#include "core/base/real.hpp"
#include "core/odometry/motion_models.hpp"

namespace crspf {
namespace {

constexpr Duration kHeldFor{1'000'000'000};
constexpr Duration kExtrapolation{200'000'000};
constexpr double kLargestStep_m = 10.0;
constexpr double kLargestTurn_rad = kPi;

// The bias of an IMU's yaw rate. Standing still it tells it itself; on the move the corrections do, from which a bias
// is learnt within a minute: it changes as slowly as the sensor warms.
constexpr double kMovingBias_s = 20.0;
constexpr double kJump_rad = 0.1;  // a correction by more is no drift
constexpr Duration kCorrections{2'000'000'000};

}  // namespace

void Odometry::add(const DifferentialSample& sample) {
    ++counters_.samples;
    if (!is_finite(sample.left_m) || !is_finite(sample.right_m)) {
        ++counters_.not_finite;
        return;
    }
    const double left_m = params_.left_wheel_factor * sample.left_m;
    const double right_m = params_.right_wheel_factor * sample.right_m;
    const double turn_rad = (right_m - left_m) / params_.wheel_span_m;
    if (absolute(turn_rad) > kLargestTurn_rad) {
        ++counters_.implausible;
        return;
    }
    advance({.stamp = sample.stamp, .P_previous_base = differential_motion(left_m, right_m, params_.wheel_span_m)});
}

void Odometry::add(const AckermannSample& sample) {
    ++counters_.samples;
    if (!is_finite(sample.speed_mps) || !is_finite(sample.steering_rad)) {
        ++counters_.not_finite;
        return;
    }
    const AckermannSample at_rear = at_rear_axle(sample);
    double dt_s = 0.0;
    if (usable_interval(sample.stamp, dt_s)) {
        // The mean of both ends: second order, where holding one end would lag by half an interval.
        const Pose2 step =
            ackermann_motion(0.5 * (held_ackermann_.speed_mps + at_rear.speed_mps),
                             0.5 * (held_ackermann_.steering_rad + at_rear.steering_rad), params_.wheel_base_m, dt_s);
        advance({.stamp = sample.stamp, .P_previous_base = step});
    }
    held_ackermann_ = at_rear;
}

AckermannSample Odometry::at_rear_axle(const AckermannSample& sample) const {
    AckermannSample out = sample;
    out.steering_rad += params_.steering_offset_rad;
    out.speed_mps *= params_.speed_factor;
    if (params_.front_driven) {  // the front wheels roll along a wider circle
        out.speed_mps *= sin_cos(out.steering_rad).cos;
    }
    return out;
}

void Odometry::add(const ImuSample& sample) {
    ++counters_.samples;
    if (!is_finite(sample.speed_mps) || !is_finite(sample.yaw_rate_radps)) {
        ++counters_.not_finite;
        return;
    }
    speed_told_ = sample.speed_told;
    ImuSample level = in_base(sample);
    if (imu_.tilted() && (!sample.inertial || !is_finite(level.yaw_rate_radps))) {
        ++counters_.askew;
        return;
    }
    const bool felt = level.inertial.has_value();
    if (felt) {
        level = inertial_.add(level);
        level.speed_told = sample.speed_told;
    }
    double dt_s = 0.0;
    if (usable_interval(sample.stamp, dt_s)) {
        learn_standing(level, dt_s);
        level.yaw_rate_radps -= bias_radps_;
        double felt_m = 0.0;
        if (!sample.speed_told) {
            const double before_mps = speed_.felt_mps();
            held_imu_.speed_mps = speed_.speed_mps();
            speed_.accelerate(felt ? inertial_.forward_mps2().value_or(0.0) : 0.0, dt_s, felt);
            level.speed_mps = speed_.speed_mps();
            felt_m = 0.5 * (before_mps + speed_.felt_mps()) * dt_s;
        }
        const Pose2 step = imu_motion(0.5 * (held_imu_.speed_mps + level.speed_mps),
                                      0.5 * (held_imu_.yaw_rate_radps + level.yaw_rate_radps), dt_s);
        advance({.stamp = sample.stamp, .P_previous_base = step}, felt_m);
    } else {
        level.yaw_rate_radps -= bias_radps_;
    }
    held_imu_ = level;
}

ImuSample Odometry::in_base(const ImuSample& sample) const {
    ImuSample turned = sample;
    turned.speed_mps = turned.speed_told ? turned.speed_mps * params_.speed_factor : speed_.speed_mps();
    imu_.to_base(turned);
    return turned;
}

void Odometry::learn_standing(const ImuSample& sample, double dt_s) {
    const double rest_radps = sample.yaw_rate_radps - bias_radps_;
    standing_.add(sample.speed_told && Standing::is_still(sample.speed_mps) && Standing::is_still_turn(rest_radps),
                  dt_s);
    if (standing_.is_settled()) {
        bias_radps_ = clamped_gyro_bias(bias_radps_ + Standing::bias_share(dt_s) * rest_radps);
    }
}

void Odometry::learn_moving(Stamp stamp, double corrected_rad) {
    const Duration since = stamp - corrected_;
    const bool first = corrected_ == Stamp{};
    corrected_ = stamp;
    // Standing, the scans have less to say than the gyroscope.
    if (first || held_imu_.stamp == Stamp{} || standing_.has_begun() || since.ns <= 0 || since > kCorrections ||
        absolute(corrected_rad) > kJump_rad) {
        return;
    }
    bias_radps_ = clamped_gyro_bias(bias_radps_ - corrected_rad / kMovingBias_s);
}

void Odometry::learn_speed(Stamp stamp, const Pose2& P_map_base) {
    const Duration since = stamp - corrected_;
    const std::optional<Pose2> P_map_before = std::exchange(P_map_corrected_, P_map_base);
    if (speed_told_ || !P_map_before || since.ns <= 0 || since > kCorrections) {
        return;
    }
    const Pose2 step = inverse(*P_map_before) * P_map_base;
    // Along the arc's chord, which points half the turn away from its beginning.
    const SinCos half = sin_cos(0.5 * step.theta_rad);
    const double way_m = half.cos * step.x_m + half.sin * step.y_m;
    const double felt_m = state_at(stamp).felt_m - state_at(corrected_).felt_m;
    speed_.measure((way_m - felt_m) / since.seconds(), corrected_, stamp);
}

void Odometry::add(const MotionSample& sample) {
    ++counters_.samples;
    const Pose2& step = sample.P_previous_base;
    if (!is_finite(step.x_m) || !is_finite(step.y_m) || !is_finite(step.theta_rad) ||
        !is_finite(sample.translation_variance_m2) || !is_finite(sample.rotation_variance_rad2)) {
        ++counters_.not_finite;
        return;
    }
    if (sample.translation_variance_m2 < 0.0 || sample.rotation_variance_rad2 < 0.0) {
        ++counters_.implausible;
        return;
    }
    advance(sample);
}

void Odometry::set_pose(const Pose2& P_map_base) {
    P_map_odom_ = P_map_base * inverse(newest().P_odom_base);
    P_map_corrected_.reset();
}

MotionPrior Odometry::motion_between(Stamp from, Stamp to) const {
    const State a = state_at(from);
    const State b = state_at(to);
    const double travelled_m = absolute(b.travelled_m - a.travelled_m);
    const double turned_rad = absolute(b.turned_rad - a.turned_rad);
    const double translation_m = params_.translation_per_metre * travelled_m;
    const double by_speed_m = speed_told_ ? 0.0 : speed_.stddev_mps(to) * absolute((to - from).seconds());
    const double by_turn_rad = params_.rotation_per_radian * turned_rad;
    const double by_path_rad = params_.rotation_per_metre * travelled_m;
    const double told_m2 = absolute(b.doubt_m2 - a.doubt_m2);
    const double told_rad2 = absolute(b.doubt_rad2 - a.doubt_rad2);
    return {.P_from_to = inverse(a.P_odom_base) * b.P_odom_base,
            .translation_stddev_m =
                square_root(square(params_.translation_floor_m) + square(translation_m) + square(by_speed_m) + told_m2),
            .rotation_stddev_rad =
                square_root(square(params_.rotation_floor_rad) + square(by_turn_rad) + square(by_path_rad) + told_rad2),
            .told_stddev_m = square_root(told_m2)};
}

void Odometry::correct(Stamp stamp, const Pose2& P_map_base) {
    const Pose2 before = P_map_odom_;
    P_map_odom_ = P_map_base * inverse(state_at(stamp).P_odom_base);
    learn_speed(stamp, P_map_base);
    learn_moving(stamp, wrap_angle(P_map_odom_.theta_rad - before.theta_rad));
}

Odometry::State Odometry::state_at(Stamp stamp) const {
    if (count_ == 0) {
        return {};
    }
    const auto back = [this](std::size_t steps) -> const State& {
        return history_[(newest_ + capacity::kMotionHistory - steps) % capacity::kMotionHistory];
    };
    const State& last = newest();
    if (stamp >= last.stamp) {
        if (count_ < 2 || stamp == last.stamp) {
            return last;
        }
        const State& before = back(1);
        const Duration step = last.stamp - before.stamp;
        if (step.ns <= 0 || step > kHeldFor) {
            return last;
        }
        const Duration ahead = std::min(stamp - last.stamp, kExtrapolation);
        const double u = static_cast<double>(ahead.ns) / static_cast<double>(step.ns);
        const Pose2 moved = inverse(before.P_odom_base) * last.P_odom_base;
        State result = last;
        result.P_odom_base =
            last.P_odom_base * Pose2{.x_m = u * moved.x_m, .y_m = u * moved.y_m, .theta_rad = u * moved.theta_rad};
        result.travelled_m += u * (last.travelled_m - before.travelled_m);
        result.turned_rad += u * (last.turned_rad - before.turned_rad);
        result.felt_m += u * (last.felt_m - before.felt_m);
        result.doubt_m2 += u * (last.doubt_m2 - before.doubt_m2);
        result.doubt_rad2 += u * (last.doubt_rad2 - before.doubt_rad2);
        return result;
    }
    // Stamps grow with the index, so the first state at or before `stamp` is found by halving.
    std::size_t newer = 0;
    std::size_t older = count_ - 1;
    if (back(older).stamp > stamp) {
        ++counters_.out_of_history;
        return back(older);
    }
    while (older - newer > 1) {
        const std::size_t middle = (older + newer) / 2;
        (back(middle).stamp <= stamp ? older : newer) = middle;
    }
    const State& a = back(older);
    const State& b = back(newer);
    const double u = static_cast<double>((stamp - a.stamp).ns) / static_cast<double>((b.stamp - a.stamp).ns);
    return {.stamp = stamp,
            .P_odom_base = interpolate(a.P_odom_base, b.P_odom_base, u),
            .travelled_m = a.travelled_m + u * (b.travelled_m - a.travelled_m),
            .turned_rad = a.turned_rad + u * (b.turned_rad - a.turned_rad),
            .felt_m = a.felt_m + u * (b.felt_m - a.felt_m),
            .doubt_m2 = a.doubt_m2 + u * (b.doubt_m2 - a.doubt_m2),
            .doubt_rad2 = a.doubt_rad2 + u * (b.doubt_rad2 - a.doubt_rad2)};
}

bool Odometry::usable_interval(Stamp stamp, double& dt_s) {
    if (count_ == 0) {
        advance({.stamp = stamp, .P_previous_base = {}});
        return false;
    }
    const Duration dt = stamp - newest().stamp;
    if (dt.ns < 0) {
        ++counters_.ran_back;
        return false;
    }
    if (dt > kHeldFor) {
        ++counters_.gaps;
        advance({.stamp = stamp, .P_previous_base = {}});
        return false;
    }
    dt_s = dt.seconds();
    return true;
}

void Odometry::advance(const MotionSample& motion, double felt_m) {
    const Pose2& P_previous_base = motion.P_previous_base;
    const double squared_m2 = square(P_previous_base.x_m) + square(P_previous_base.y_m);
    if (!(squared_m2 <= square(kLargestStep_m))) {  // nor NaN, which finite samples give when their sum overflows
        ++counters_.implausible;
        return;
    }
    State next = newest();
    if (count_ > 0 && motion.stamp < next.stamp) {
        ++counters_.ran_back;  // the motion happened; only its stamp is wrong
    } else {
        next.stamp = motion.stamp;
    }
    next.P_odom_base = next.P_odom_base * P_previous_base;
    next.travelled_m += square_root(squared_m2);
    next.felt_m += felt_m;
    next.turned_rad += absolute(wrap_angle(P_previous_base.theta_rad));
    // As sure as no robot moves farther; the sums must not overflow.
    next.doubt_m2 += std::min(motion.translation_variance_m2, square(kLargestStep_m));
    next.doubt_rad2 += std::min(motion.rotation_variance_rad2, square(kLargestTurn_rad));
    newest_ = count_ == 0 ? 0 : (newest_ + 1) % capacity::kMotionHistory;
    history_[newest_] = next;
    count_ = std::min(count_ + 1, capacity::kMotionHistory);
}

}  // namespace crspf
