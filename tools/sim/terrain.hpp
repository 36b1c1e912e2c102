// Ground that is not level, and how a vehicle stands on it.
#pragma once

#include <vector>

#include "core/base/pose.hpp"
#include "core/odometry/attitude.hpp"
#include "tools/sim/world.hpp"

namespace crspf::sim {

/// A gentle slope with bumps on it.
class Terrain {
 public:
    static constexpr double kSlopeX = 0.010;  ///< rise along x ...
    static constexpr double kSlopeY = -0.006;

    /// @param bumps_rad no bump is steeper; most are less than half as steep
    explicit Terrain(double bumps_rad = 0.0);

    /// [m] 0 at the origin
    [[nodiscard]] double height_m(Point p) const;
    /// In no direction does the ground rise by more. [m/m]
    [[nodiscard]] double steepest() const { return steepest_; }

 private:
    struct Wave {
        double per_m_x;  ///< [rad/m]
        double per_m_y;
        double amplitude_m;
    };
    std::vector<Wave> waves_;  ///< the bumps are their sum
    double steepest_;
};

/// A body in the world: where it is, and its axes, x forward, y left, z up.
struct Frame {
    Vector3 origin;
    Vector3 x{.x = 1.0, .y = 0.0, .z = 0.0};
    Vector3 y{.x = 0.0, .y = 1.0, .z = 0.0};
    Vector3 z{.x = 0.0, .y = 0.0, .z = 1.0};

    /// A vector of the body's axes, as the world sees it.
    [[nodiscard]] Vector3 turned(const Vector3& v) const { return v.x * x + v.y * y + v.z * z; }
    /// The other way.
    [[nodiscard]] Vector3 seen(const Vector3& v) const { return {.x = dot(x, v), .y = dot(y, v), .z = dot(z, v)}; }
};

/// On a level floor.
[[nodiscard]] Frame level_frame(const Pose2& P_world_base);

/// On four wheels, `length_m` and `width_m` apart, which bear alike: base_link in their middle, on the ground.
[[nodiscard]] Frame frame_on(const Terrain& terrain, const Pose2& P_world_base, double length_m, double width_m);

}  // namespace crspf::sim
