#include "platform/capture/timeline.hpp"

#include <algorithm>
#include <span>

namespace crspf {

Stamp Timeline::place(Source source, double recorded_s) {
    Track& track = tracks_[static_cast<std::size_t>(source)];
    if (!started_) {
        started_ = true;
        anchor_s_ = recorded_s;
        newest_s_ = recorded_s;
    }
    Stamp stamp;
    if (believable(track, recorded_s)) {
        stamp = on_line(recorded_s);
        if (track.seen) {
            track.add(stamp - track.last);
        }
    } else {
        ++jumps_;
        stamp = track.seen ? std::max(newest_, track.last + track.typical()) : newest_;
        anchor_s_ = recorded_s;
        anchor_ = stamp;
    }
    if (stamp >= newest_) {
        newest_s_ = recorded_s;
        newest_ = stamp;
    }
    track.seen = true;
    track.last = stamp;
    return stamp;
}

bool Timeline::believable(const Track& track, double recorded_s) const {
    const double step_s = recorded_s - newest_s_;
    return step_s >= -kLateMax_s && step_s <= kGapMax_s && (!track.seen || on_line(recorded_s) >= track.last);
}

Stamp Timeline::on_line(double recorded_s) const {
    return anchor_ + Duration::from_seconds(recorded_s - anchor_s_);
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
    const std::span known = std::span(sorted).first(std::min(count, kIntervals));
    const auto middle = known.begin() + static_cast<std::ptrdiff_t>(known.size() / 2);
    std::nth_element(known.begin(), middle, known.end());
    return *middle;
}

}  // namespace crspf
