// How the vehicle is tilted: where up is, seen from base_link. Heading has no part in it.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>

#include "config/capacities.hpp"
#include "core/base/real.hpp"
#include "core/base/time.hpp"

namespace crspf {

/// A vector in base_link's axes (REP-103: x forward, y left, z up).
struct Vector3 {
    double x = 0.0;
    double y = 0.0;
    double z = 0.0;

    friend bool operator==(const Vector3&, const Vector3&) = default;
    friend constexpr Vector3 operator+(const Vector3& a, const Vector3& b) {
        return {.x = a.x + b.x, .y = a.y + b.y, .z = a.z + b.z};
    }
    friend constexpr Vector3 operator-(const Vector3& a, const Vector3& b) {
        return {.x = a.x - b.x, .y = a.y - b.y, .z = a.z - b.z};
    }
    friend constexpr Vector3 operator*(double s, const Vector3& v) {
        return {.x = s * v.x, .y = s * v.y, .z = s * v.z};
    }
};

[[nodiscard]] constexpr double dot(const Vector3& a, const Vector3& b) {
    return a.x * b.x + a.y * b.y + a.z * b.z;
}
[[nodiscard]] constexpr Vector3 cross(const Vector3& a, const Vector3& b) {
    return {.x = a.y * b.z - a.z * b.y, .y = a.z * b.x - a.x * b.z, .z = a.x * b.y - a.y * b.x};
}
[[nodiscard]] inline double length(const Vector3& v) {
    return square_root(dot(v, v));
}

inline constexpr Vector3 kLevel{.x = 0.0, .y = 0.0, .z = 1.0};

/// The unit vector that points up, at the instants of the past; level where none is known. No heap, no throw; one
/// owner.
class AttitudeHistory {
 public:
    /// Stamps that run back are not taken.
    void add(Stamp stamp, const Vector3& up) {
        if (count_ > 0 && stamp <= newest().stamp) {
            return;
        }
        newest_ = count_ == 0 ? 0 : (newest_ + 1) % capacity::kAttitudes;
        history_[newest_] = {.stamp = stamp, .up = up};
        count_ = std::min(count_ + 1, capacity::kAttitudes);
    }

    /// Interpolated; held at the history's ends. Its length is 1 but for the interpolation.
    [[nodiscard]] Vector3 up_at(Stamp stamp) const {
        if (count_ == 0) {
            return kLevel;
        }
        if (stamp >= newest().stamp) {
            return newest().up;
        }
        if (stamp <= back(count_ - 1).stamp) {
            return back(count_ - 1).up;
        }
        std::size_t newer = 0;
        std::size_t older = count_ - 1;
        while (older - newer > 1) {
            const std::size_t middle = (older + newer) / 2;
            (back(middle).stamp <= stamp ? older : newer) = middle;
        }
        const Entry& a = back(older);
        const Entry& b = back(newer);
        const double u = static_cast<double>((stamp - a.stamp).ns) / static_cast<double>((b.stamp - a.stamp).ns);
        return a.up + u * (b.up - a.up);
    }

 private:
    struct Entry {
        Stamp stamp;
        Vector3 up;
    };
    [[nodiscard]] const Entry& back(std::size_t steps) const {
        return history_[(newest_ + capacity::kAttitudes - steps) % capacity::kAttitudes];
    }
    [[nodiscard]] const Entry& newest() const { return history_[newest_]; }

    std::array<Entry, capacity::kAttitudes> history_{};
    std::size_t newest_ = 0;
    std::size_t count_ = 0;
};

}  // namespace crspf
