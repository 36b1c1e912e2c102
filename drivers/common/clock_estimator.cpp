#include "drivers/common/clock_estimator.hpp"

#include <algorithm>
#include <cmath>  // floor

namespace crspf {
namespace {

constexpr double kBucket_s = 0.5;
constexpr double kDriftSpan_s = 3.0;
constexpr double kMaxDrift = 5e-3;  // no quartz is off by more; what looks like it is a queue running empty
constexpr double kEarly_s = 0.05;
constexpr double kLate_s = 0.1;
constexpr double kLateFor_s = 3.0;

}  // namespace

void ClockEstimator::reset() {
    const std::uint64_t resets = resets_;
    *this = ClockEstimator{};
    resets_ = resets;
}

void ClockEstimator::restart() {
    reset();
    ++resets_;
}

void ClockEstimator::add(Stamp device, Stamp received) {
    if (known()) {
        const double late_s = (received - to_host(device)).seconds();
        const double device_s = (device - origin_).seconds();
        if (late_s <= kLate_s) {
            late_since_s_ = -1.0;
        } else if (late_since_s_ < 0.0) {
            late_since_s_ = device_s;
        }
        const bool moved = late_since_s_ >= 0.0 && device_s - late_since_s_ > kLateFor_s;
        if (device_s < last_device_s_ || late_s < -kEarly_s || moved) {
            restart();
        }
    }
    if (!known()) {
        origin_ = device;
        origin_offset_ns_ = received.ns - device.ns;
    }
    const double device_s = (device - origin_).seconds();
    const double offset_s = Duration{received.ns - device.ns - origin_offset_ns_}.seconds();
    last_device_s_ = device_s;
    insert({static_cast<std::int64_t>(std::floor(device_s / kBucket_s)), device_s, offset_s});
    fit();
}

// Within a bucket the most punctual message stands for all.
void ClockEstimator::insert(const Point& point) {
    if (size_ > 0 && points_[size_ - 1].bucket == point.bucket) {
        Point& last = points_[size_ - 1];
        if (point.offset_s - drift_ * (point.device_s - last.device_s) < last.offset_s) {
            last = point;
        }
        return;
    }
    const auto expired = [&](const Point& p) { return p.bucket + static_cast<std::int64_t>(kBuckets) <= point.bucket; };
    Point* const begin = points_.data();
    Point* const end = std::remove_if(begin, begin + size_, expired);
    size_ = static_cast<std::size_t>(end - begin);
    points_[size_++] = point;
}

void ClockEstimator::fit() {
    double mean_s = 0.0;
    for (std::size_t i = 0; i < size_; ++i) {
        mean_s += points_[i].device_s;
    }
    mean_s /= static_cast<double>(size_);

    std::array<Point, kBuckets> hull{};
    std::size_t corners = 0;
    for (std::size_t i = 0; i < size_; ++i) {
        const Point& c = points_[i];
        while (corners >= 2) {
            const Point& a = hull[corners - 2];
            const Point& b = hull[corners - 1];
            const double turn = (b.device_s - a.device_s) * (c.offset_s - a.offset_s) -
                                (b.offset_s - a.offset_s) * (c.device_s - a.device_s);
            if (turn > 0.0) {
                break;
            }
            --corners;
        }
        hull[corners++] = c;
    }

    if (points_[size_ - 1].device_s - points_[0].device_s >= kDriftSpan_s) {
        std::size_t right = 1;
        while (right + 1 < corners && hull[right].device_s < mean_s) {
            ++right;
        }
        const Point& a = hull[right - 1];
        const Point& b = hull[right];
        drift_ = std::clamp((b.offset_s - a.offset_s) / (b.device_s - a.device_s), -kMaxDrift, kMaxDrift);
    }
    // The line of that slope that touches the hull from below; with a slope that is not its edge's, at one corner.
    reference_s_ = mean_s;
    for (std::size_t i = 0; i < corners; ++i) {
        const double at_s = hull[i].offset_s + drift_ * (mean_s - hull[i].device_s);
        at_reference_s_ = i == 0 ? at_s : std::min(at_reference_s_, at_s);
    }
}

Stamp ClockEstimator::to_host(Stamp device) const {
    const double device_s = (device - origin_).seconds();
    const double offset_s = at_reference_s_ + drift_ * (device_s - reference_s_);
    return {device.ns + origin_offset_ns_ + Duration::from_seconds(offset_s).ns};
}

}  // namespace crspf
