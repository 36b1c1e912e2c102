// The clock of a device on the host's time line, learnt from when its messages arrive.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "core/base/time.hpp"

namespace crspf {

/// A message is never received before it was sent, but may be late by any amount. In the plane of device time and
/// (host - device) all messages therefore lie above the line that is sought, and the punctual ones on it. The line is
/// the edge of their lower convex hull under their mean device time: of all lines below them the one nearest to them.
///
/// The smallest delay cannot be told from an offset of the clocks; to_host() includes it. Whoever knows it subtracts it
/// from `received`. Device stamps that are rounded down do no harm: rounding, too, only makes a message look late.
///
/// Memory: the most punctual message of each half second for 30 s. add() costs O(kBuckets), to_host() O(1); no heap,
/// wait-free.
class ClockEstimator {
 public:
    /// A message that the device stamped `device` (any origin, not wrapping) and the host `received`. The estimate
    /// starts afresh where the device's time went back, where a message came more than 50 ms before it can have been
    /// sent, or where all messages of 3 s came more than 100 ms late: the device was reset or stood still.
    void add(Stamp device, Stamp received);

    [[nodiscard]] bool known() const { return size_ > 0; }
    /// The host's time at the device's. Only where known().
    [[nodiscard]] Stamp to_host(Stamp device) const;
    /// Host seconds per device second, minus 1; 0 until 3 s were seen.
    [[nodiscard]] double drift() const { return drift_; }
    /// How often the estimate started afresh by itself.
    [[nodiscard]] std::uint64_t resets() const { return resets_; }
    /// Forget everything but the count of resets.
    void reset();

 private:
    static constexpr std::size_t kBuckets = 60;

    struct Point {
        std::int64_t bucket = 0;
        double device_s = 0.0;  // since origin_
        double offset_s = 0.0;  // host - device, less origin_offset_ns_
    };

    void restart();
    void insert(const Point& point);
    void fit();

    std::array<Point, kBuckets> points_{};  // oldest first
    std::size_t size_ = 0;
    Stamp origin_;
    std::int64_t origin_offset_ns_ = 0;
    double last_device_s_ = 0.0;
    double late_since_s_ = -1.0;  // device time of the first of an unbroken row of late messages; negative: none
    double reference_s_ = 0.0;    // the line: offset = at_reference_s_ + drift_ * (device - reference_s_)
    double at_reference_s_ = 0.0;
    double drift_ = 0.0;
    std::uint64_t resets_ = 0;
};

}  // namespace crspf
