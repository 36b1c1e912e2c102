// One monotone line of time out of recorded stamps that jump.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "core/base/time.hpp"

namespace crspf {

/// Recordings hold stamps that run back or leap: clocks were set, messages came late, logs were pieced together. The
/// order of the file is right. So each stamp moves the line by its difference from the stamp before; one that runs
/// back, or ahead by more than kGapMax_s, moves it by the interval that is typical for its source instead.
/// Fixed memory. The line starts at 0 and never runs back.
class Timeline {
 public:
    /// Who wrote the stamp; each has its own typical interval.
    enum class Source : std::uint8_t { kOdometry, kFrontLaser, kRobotLaser };

    /// A leap ahead beyond this is a clock that was set, not a pause of the robot. [s]
    static constexpr double kGapMax_s = 60.0;

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

    std::array<Track, 3> tracks_{};
    bool started_ = false;
    double recorded_s_ = 0.0;
    Stamp now_;
    std::uint64_t jumps_ = 0;
};

}  // namespace crspf
