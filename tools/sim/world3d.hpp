// The world as a lidar of many rings sees it: walls of some height on uneven ground, with kerbs and trees.
#pragma once

#include <cstdint>
#include <vector>

#include "core/odometry/attitude.hpp"
#include "tools/sim/scene.hpp"
#include "tools/sim/terrain.hpp"
#include "tools/sim/world.hpp"

namespace crspf::sim {

enum class Surface : std::uint8_t { kNothing, kGround, kKerb, kWall, kPerson, kCrown, kCar };

struct Echo {
    double range_m = 0.0;  ///< along the ray
    Surface surface = Surface::kNothing;
};

/// A place that lies higher than the ground round it: a traffic island, its sides the kerb.
struct Island {
    Point lower;
    Point upper;
};

/// Heights of walls, kerbs, crowns, people and cars are counted from the ground below, so that a wall is as high
/// everywhere. Nobody drives or walks onto an island.
class World3d {
 public:
    static constexpr double kWallHeight_m = 2.5;
    static constexpr double kKerbHeight_m = 0.12;
    static constexpr double kPersonHeight_m = 1.7;

    World3d(World walls, std::vector<Island> islands, std::vector<Crown> crowns, Terrain terrain);
    /// The scene, with islands wherever there is room for the robot to drive round one.
    World3d(const Scene& scene, const Terrain& terrain);

    /// The nearest surface on the way.
    /// @param origin of the ray, above the ground and below the walls' top  @param direction of length 1, not vertical
    [[nodiscard]] Echo cast(const Vector3& origin, const Vector3& direction, const Movers& movers,
                            double range_max_m) const;

    [[nodiscard]] const Terrain& terrain() const { return terrain_; }
    /// What a robot must not touch, seen from above: walls and kerbs.
    [[nodiscard]] const World& obstacles() const { return obstacles_; }
    [[nodiscard]] const std::vector<Island>& islands() const { return islands_; }

 private:
    World walls_;
    std::vector<Island> islands_;
    std::vector<Crown> crowns_;
    Terrain terrain_;
    World obstacles_;
};

}  // namespace crspf::sim
