#include "tools/sim/imu_model.hpp"

namespace crspf::sim {

ImuRecord ImuModel::update(const Frame& now, double seconds) {
    // Of a small turn the rotation's antisymmetric part is the turn.
    const double half_rate = 0.5 / seconds;
    const Vector3 rate_radps{.x = half_rate * (dot(before_.z, now.y) - dot(before_.y, now.z)),
                             .y = half_rate * (dot(before_.x, now.z) - dot(before_.z, now.x)),
                             .z = half_rate * (dot(before_.y, now.x) - dot(before_.x, now.y))};
    const Vector3 velocity_mps = (1.0 / seconds) * (now.origin - before_.origin);
    const Vector3 acceleration_mps2 = (1.0 / seconds) * (velocity_mps - velocity_mps_);
    before_ = now;
    velocity_mps_ = velocity_mps;
    return {.rate_radps = rate_radps, .force_mps2 = now.seen(acceleration_mps2 + ImuRecord{}.force_mps2)};
}

}  // namespace crspf::sim
