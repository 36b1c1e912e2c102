#include "tools/sim/world3d.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace crspf::sim {
namespace {

constexpr double kIslandLength_m = 1.6;
constexpr double kIslandWidth_m = 0.8;
constexpr double kRoom_m = 1.9;       // from an island's middle to the next wall: a robot passes it
constexpr double kFromStart_m = 3.0;  // from its middle to the robot's first place
constexpr double kBetweenIslands_m = 5.0;
constexpr double kSearchStep_m = 0.5;
constexpr std::size_t kIslandsMax = 4;

bool is_free(const GridMap& map, Point p) {
    const Pose2 in_map = inverse(map.P_map_origin) * Pose2{.x_m = p.x_m, .y_m = p.y_m, .theta_rad = 0.0};
    const int column = static_cast<int>(std::floor(in_map.x_m / map.resolution_m));
    const int row = static_cast<int>(std::floor(in_map.y_m / map.resolution_m));
    return column >= 0 && row >= 0 && column < map.width && row < map.height && map.at(column, row) == GridCell::kFree;
}

std::vector<Island> islands_of(const Scene& scene) {
    std::vector<Point> middles;
    const Point start{scene.P_world_start.x_m, scene.P_world_start.y_m};
    const Point lower = scene.world.lower();
    const int columns = static_cast<int>((scene.world.upper().x_m - lower.x_m) / kSearchStep_m);
    const int rows = static_cast<int>((scene.world.upper().y_m - lower.y_m) / kSearchStep_m);
    for (int i = 0; i < rows * columns && middles.size() < kIslandsMax; ++i) {
        const int column = i % columns;
        const int row = i / columns;
        const Point p{lower.x_m + column * kSearchStep_m, lower.y_m + row * kSearchStep_m};
        const bool apart = std::all_of(middles.begin(), middles.end(),
                                       [&](Point other) { return distance(p, other) > kBetweenIslands_m; });
        if (apart && distance(p, start) > kFromStart_m && is_free(scene.truth, p) &&
            scene.world.clearance(p, kRoom_m) >= kRoom_m) {
            middles.push_back(p);
        }
    }
    std::vector<Island> islands(middles.size());
    std::transform(middles.begin(), middles.end(), islands.begin(), [](Point p) {
        return Island{.lower = {p.x_m - kIslandLength_m / 2.0, p.y_m - kIslandWidth_m / 2.0},
                      .upper = {p.x_m + kIslandLength_m / 2.0, p.y_m + kIslandWidth_m / 2.0}};
    });
    return islands;
}

World with_kerbs(const World& walls, const std::vector<Island>& islands) {
    std::vector<Segment> all = walls.walls();
    for (const Island& i : islands) {
        const Point a = i.lower;
        const Point b{i.upper.x_m, i.lower.y_m};
        const Point c = i.upper;
        const Point d{i.lower.x_m, i.upper.y_m};
        all.insert(all.end(), {{a, b}, {b, c}, {c, d}, {d, a}});
    }
    return World(std::move(all));
}

// The part of a ray, by the way over ground, in which one coordinate lies between two bounds.
struct Part {
    double from_m = 0.0;
    double to_m = kInfinity;

    void cut(double origin, double rate, double low, double high) {
        if (rate == 0.0) {
            to_m = origin >= low && origin <= high ? to_m : -kInfinity;
            return;
        }
        const double a = (low - origin) / rate;
        const double b = (high - origin) / rate;
        from_m = std::max(from_m, std::min(a, b));
        to_m = std::min(to_m, std::max(a, b));
    }
};

}  // namespace

World3d::World3d(World walls, std::vector<Island> islands)
    : walls_(std::move(walls)), islands_(std::move(islands)), obstacles_(with_kerbs(walls_, islands_)) {}

World3d::World3d(const Scene& scene) : World3d(scene.world, islands_of(scene)) {}

// Seen from the slope, heights along the ray still change evenly: there the ground is level.
Echo World3d::cast(Point origin, double height_m, SinCos azimuth, SinCos elevation, const std::vector<Circle>& people,
                   double range_max_m) const {
    const double above_m = height_m - ground_m(origin);
    const double rise = elevation.sin / elevation.cos - (kSlopeX * azimuth.cos + kSlopeY * azimuth.sin);
    double way_m = rise < 0.0 ? above_m / -rise : kInfinity;
    Surface surface = Surface::kGround;
    const auto meet = [&](double at_m, double top_m, Surface what) {
        if (at_m < way_m && above_m + rise * at_m <= top_m) {
            way_m = at_m;
            surface = what;
        }
    };
    for (const Island& i : islands_) {
        Part part;
        part.cut(origin.x_m, azimuth.cos, i.lower.x_m, i.upper.x_m);
        part.cut(origin.y_m, azimuth.sin, i.lower.y_m, i.upper.y_m);
        part.cut(above_m, rise, -kKerbHeight_m, kKerbHeight_m);
        if (part.from_m < part.to_m) {
            meet(part.from_m, kInfinity, Surface::kKerb);
        }
    }
    for (const Circle& person : people) {
        meet(cast_on_circle(origin, azimuth, person), kPersonHeight_m, Surface::kPerson);
    }
    // A ray that passes above a wall rises, and passes above all others behind it.
    meet(walls_.cast(origin, azimuth, std::min(way_m, range_max_m * elevation.cos)), kWallHeight_m, Surface::kWall);
    const double range_m = way_m / elevation.cos;
    return range_m <= range_max_m ? Echo{range_m, surface} : Echo{};
}

}  // namespace crspf::sim
