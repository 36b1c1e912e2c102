#include "drivers/velodyne/velodyne_clock.hpp"

#include <algorithm>

namespace crspf {
namespace {

constexpr std::int64_t kHour_ns = 3600000000000;
constexpr std::int64_t kStep_ns = 500000000;
// Quartz clocks of both sides together drift by less than this share.
constexpr std::int64_t kDriftParts = 10000;

}  // namespace

Stamp resolve_hour(std::uint32_t stamp_us, Stamp near) {
    const std::int64_t shown_ns = static_cast<std::int64_t>(stamp_us) * 1000;
    std::int64_t ahead_ns = (shown_ns - near.ns) % kHour_ns;
    ahead_ns += ahead_ns < -kHour_ns / 2 ? kHour_ns : 0;
    ahead_ns -= ahead_ns >= kHour_ns / 2 ? kHour_ns : 0;
    return near + Duration{ahead_ns};
}

void VelodyneClock::observe(std::uint32_t stamp_us, Duration complete, Stamp received) {
    const Stamp expected = received - offset_ - complete;
    const Stamp sensor = resolve_hour(stamp_us, expected);
    const std::int64_t late_ns = (expected - sensor).ns;  // than the offset says
    const bool step = late_ns > kStep_ns || late_ns < -kStep_ns;
    steps_ += known_ && step ? 1 : 0;
    const std::int64_t passed_ns = std::max<std::int64_t>((received - received_).ns, 0);
    // An early one, late_ns below zero, is followed at once.
    offset_.ns += !known_ || step ? late_ns : std::min(late_ns, passed_ns / kDriftParts);
    if (!known_ || step) {
        adopt();
    }
    known_ = true;
    received_ = received;
}

Stamp VelodyneClock::at(std::uint32_t stamp_us) const {
    return resolve_hour(stamp_us, received_ - used_offset_) + used_offset_;
}

}  // namespace crspf
