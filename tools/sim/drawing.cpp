#include "tools/sim/drawing.hpp"

#include <utility>

#include "tools/sim/map_walls.hpp"

namespace crspf::sim {

Scene finish(const Drawing& drawing, const Pose2& P_world_start, std::vector<Point> tour, double resolution_m) {
    World world = drawing.world();
    GridMap truth = rasterize(world, {P_world_start.x_m, P_world_start.y_m}, resolution_m);
    return {
        .world = std::move(world), .P_world_start = P_world_start, .tour = std::move(tour), .truth = std::move(truth)};
}

}  // namespace crspf::sim
