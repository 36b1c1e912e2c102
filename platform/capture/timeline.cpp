#include "platform/capture/timeline.hpp"

#include <algorithm>

namespace crspf {

Stamp Timeline::place(Source source, double recorded_s) {
    Track& track = tracks_[static_cast<std::size_t>(source)];
    const double step_s = started_ ? recorded_s - recorded_s_ : 0.0;
    if (step_s >= 0.0 && step_s <= kGapMax_s) {
        now_ = now_ + Duration::from_seconds(step_s);
        if (track.seen) {
            track.add(now_ - track.last);
        }
    } else {
        ++jumps_;
        if (track.seen) {
            now_ = std::max(now_, track.last + track.typical());
        }
    }
    started_ = true;
    recorded_s_ = recorded_s;
    track.seen = true;
    track.last = now_;
    return now_;
}

void Timeline::Track::add(Duration interval) {
    intervals[count % kIntervals] = interval;
    ++count;
}

Duration Timeline::Track::typical() const {
    if (count == 0) {
        return {};
    }
    std::array<Duration, kIntervals> sorted = intervals;
    const std::size_t size = std::min(count, kIntervals);
    const auto middle = sorted.begin() + static_cast<std::ptrdiff_t>(size / 2);
    std::nth_element(sorted.begin(), middle, sorted.begin() + static_cast<std::ptrdiff_t>(size));
    return *middle;
}

}  // namespace crspf
