// The world as a lidar of many rings sees it: walls of some height on a gentle slope, with kerbs.
#pragma once

#include <cstdint>
#include <vector>

#include "core/base/trig.hpp"
#include "tools/sim/scene.hpp"
#include "tools/sim/world.hpp"

namespace crspf::sim {

enum class Surface : std::uint8_t { kNothing, kGround, kKerb, kWall, kPerson };

struct Echo {
    double range_m = 0.0;  ///< along the ray
    Surface surface = Surface::kNothing;
};

/// A place that lies higher than the ground round it: a traffic island, its sides the kerb.
struct Island {
    Point lower;
    Point upper;
};

/// Heights of walls, kerbs and people are counted from the slope, so that a wall is as high everywhere. Nobody drives
/// or walks onto an island.
class World3d {
 public:
    static constexpr double kWallHeight_m = 2.5;
    static constexpr double kKerbHeight_m = 0.12;
    static constexpr double kPersonHeight_m = 1.7;
    static constexpr double kSlopeX = 0.010;  ///< rise of the ground along x ...
    static constexpr double kSlopeY = -0.006;

    /// Walls, slope and given islands.
    World3d(World walls, std::vector<Island> islands);
    /// The scene, with islands wherever there is room for the robot to drive round one.
    explicit World3d(const Scene& scene);

    /// Height of the ground beside the islands. [m] 0 at the origin
    [[nodiscard]] static double ground_m(Point p) { return kSlopeX * p.x_m + kSlopeY * p.y_m; }

    /// The nearest surface on the way.
    /// @param height_m of the ray's origin, on the scale of ground_m(); it must be above the ground and below the
    /// walls' top  @param azimuth counter-clockwise from x  @param elevation upward, between -90 and 90 degrees
    [[nodiscard]] Echo cast(Point origin, double height_m, SinCos azimuth, SinCos elevation,
                            const std::vector<Circle>& people, double range_max_m) const;

    /// What a robot must not touch, seen from above: walls and kerbs.
    [[nodiscard]] const World& obstacles() const { return obstacles_; }
    [[nodiscard]] const std::vector<Island>& islands() const { return islands_; }

 private:
    World walls_;
    std::vector<Island> islands_;
    World obstacles_;
};

}  // namespace crspf::sim
