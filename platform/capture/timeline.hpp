// One line of time out of recorded stamps that jump.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "core/base/time.hpp"

namespace crspf {

/// Recordings hold stamps that run back or leap: clocks were set, messages came late, logs were pieced together. The
/// order of the file is right, but for this: a scan is written when its sweep is over and has come, and stamped with
/// its first beam, so newer odometry may stand before it.
///
/// So a stamp is believed that is at most kGapMax_s newer and at most kLateMax_s older than the newest one, unless it
/// stands before the last one of its own source. Stamps that are believed keep their differences, to the nanosecond.
/// One that is not is a jump: the line goes on by the interval that is typical for its source, and the stamps that
/// follow count from there.
///
/// The line starts at 0; it is below 0 only for stamps that are late against the very first. It never runs back within
/// a source. What it has run ahead in a leap that was believed it keeps, also where the stamps run back afterwards: the
/// samples of the leap are delivered by then. Fixed memory.
class Timeline {
 public:
    /// Who wrote the stamp; each has its own order and its own typical interval.
    enum class Source : std::uint8_t { kOdometry, kScan };

    /// A leap ahead beyond this is a clock that was set, not a pause of the robot. [s]
    static constexpr double kGapMax_s = 60.0;
    /// Beyond this a stamp is not late from a sweep and its transfer: a clock was set. [s]
    static constexpr double kLateMax_s = 1.0;

    /// Where `recorded_s`, finite, stands on the line.
    Stamp place(Source source, double recorded_s);

    /// Stamps that were not believed.
    [[nodiscard]] std::uint64_t jumps() const { return jumps_; }

 private:
    static constexpr std::size_t kIntervals = 63;

    struct Track {
        bool seen = false;
        Stamp last;
        std::array<Duration, kIntervals> intervals;  ///< the latest that were believed
        std::size_t count = 0;                       ///< ever added

        void add(Duration interval);
        /// The median of the intervals; 0 where there is none yet.
        [[nodiscard]] Duration typical() const;
    };

    [[nodiscard]] bool believable(const Track& track, double recorded_s) const;
    [[nodiscard]] Stamp on_line(double recorded_s) const;

    std::array<Track, 2> tracks_{};
    bool started_ = false;
    double anchor_s_ = 0.0;  ///< the recorded stamp at anchor_: of the last jump, at first of the start
    Stamp anchor_;
    double newest_s_ = 0.0;  ///< the recorded stamp at newest_
    Stamp newest_;           ///< how far the line has come
    std::uint64_t jumps_ = 0;
};

}  // namespace crspf
