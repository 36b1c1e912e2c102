// Time as the core knows it: nanoseconds on one monotonic line that the caller supplies. The core reads no clock.
#pragma once

#include <compare>
#include <cstdint>

namespace crspf {

/// A span of time. [ns]
struct Duration {
    std::int64_t ns = 0;

    [[nodiscard]] constexpr double seconds() const { return static_cast<double>(ns) * 1e-9; }
    [[nodiscard]] static constexpr Duration from_seconds(double s) {
        return {static_cast<std::int64_t>(s * 1e9 + (s < 0.0 ? -0.5 : 0.5))};
    }
    friend constexpr auto operator<=>(Duration, Duration) = default;
};

/// An instant on the monotonic time line. [ns] since an origin that the source of the data chooses.
struct Stamp {
    std::int64_t ns = 0;

    friend constexpr auto operator<=>(Stamp, Stamp) = default;
    friend constexpr Duration operator-(Stamp a, Stamp b) { return {a.ns - b.ns}; }
    friend constexpr Stamp operator+(Stamp a, Duration d) { return {a.ns + d.ns}; }
    friend constexpr Stamp operator-(Stamp a, Duration d) { return {a.ns - d.ns}; }
};

}  // namespace crspf
