// The axis of a chart: what it spans, and where its ticks stand.
#pragma once

#include <limits>
#include <string>
#include <vector>

namespace crspf::experiments {

/// The smallest and the largest of some values.
struct Extent {
    double low = std::numeric_limits<double>::infinity();
    double high = -std::numeric_limits<double>::infinity();

    void add(double value);
    [[nodiscard]] bool empty() const { return low > high; }
};

struct Axis {
    double low = 0.0;
    double high = 1.0;  ///< above low
    bool log = false;

    /// Where a value stands on it: 0 at low, 1 at high.
    [[nodiscard]] double share_of(double value) const;
};

struct Tick {
    double value = 0.0;
    std::string label;
};

/// Whether a value has a place on an axis: finite, of a size that something measured may have, above 0 on a log axis.
[[nodiscard]] bool has_place(double value, bool log);

/// Spans all of the extent, and is never empty. A linear axis begins at 0 where that is near; a log axis at a power of
/// ten.
[[nodiscard]] Axis axis_of(const Extent& extent, bool log);

/// A linear axis with a little room at both ends, and no more: for plans.
[[nodiscard]] Axis close_axis_of(const Extent& extent);

/// At steps of 1, 2 or 5 times a power of ten; at powers of ten on a log axis. About `most` at most, at least one.
[[nodiscard]] std::vector<Tick> ticks_of(const Axis& axis, int most);

}  // namespace crspf::experiments
