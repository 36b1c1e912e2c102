#include "tools/sim/world3d.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/base/real.hpp"
#include "core/base/trig.hpp"

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
    if (!scene.route.empty()) {
        return {};  // the road is where the robot drives
    }
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

Part part_over(Point origin, SinCos azimuth, const Island& island) {
    Part part;
    part.cut(origin.x_m, azimuth.cos, island.lower.x_m, island.upper.x_m);
    part.cut(origin.y_m, azimuth.sin, island.lower.y_m, island.upper.y_m);
    return part;
}

// A ray by its way over ground.
class Way {
 public:
    Way(const Terrain& terrain, const Vector3& origin, SinCos azimuth, double rise)
        : terrain_(&terrain), origin_(origin), azimuth_(azimuth), rise_(rise) {}

    /// How high above the ground the ray is.
    [[nodiscard]] double above_m(double way_m) const {
        return origin_.z + rise_ * way_m -
               terrain_->height_m({origin_.x + azimuth_.cos * way_m, origin_.y + azimuth_.sin * way_m});
    }

    /// Where it first comes down to a height above the ground, infinity if it does not in this part.
    [[nodiscard]] double down_to(double height_m, const Part& part) const {
        constexpr double kNear_m = 1e-3;
        constexpr double kSecant_m = 1e-3;
        constexpr int kStepsMax = 1000;
        // In steps that the steepest ground could not hide a hit in, then by two of Newton's.
        const double closing = terrain_->steepest() - rise_;
        double way_m = part.from_m;
        for (int step = 0; step < kStepsMax && way_m <= part.to_m; ++step) {
            const double left_m = above_m(way_m) - height_m;
            if (left_m <= 0.0) {
                return way_m;
            }
            if (closing <= 0.0) {
                break;
            }
            if (left_m < kNear_m) {
                for (int turn = 0; turn < 2; ++turn) {
                    const double rate = (above_m(way_m + kSecant_m) - above_m(way_m)) / kSecant_m;
                    way_m += rate < 0.0 ? (above_m(way_m) - height_m) / -rate : 0.0;
                }
                if (way_m > part.to_m) {
                    break;
                }
                return way_m;
            }
            way_m += left_m / closing;
        }
        return kInfinity;
    }

 private:
    const Terrain* terrain_;
    Vector3 origin_;
    SinCos azimuth_;
    double rise_;
};

// From the side, or from below, where the heights between change about evenly.
double meet_crown(const Way& way, const Part& part, const Crown& crown) {
    const double first_m = way.above_m(part.from_m);
    if (first_m > crown.high_m) {
        return kInfinity;
    }
    if (first_m >= crown.low_m) {
        return part.from_m;
    }
    const double last_m = way.above_m(part.to_m);
    if (last_m < crown.low_m) {
        return kInfinity;
    }
    return part.from_m + (part.to_m - part.from_m) * (crown.low_m - first_m) / (last_m - first_m);
}

}  // namespace

World3d::World3d(World walls, std::vector<Island> islands, std::vector<Crown> crowns, Terrain terrain)
    : walls_(std::move(walls)),
      islands_(std::move(islands)),
      crowns_(std::move(crowns)),
      terrain_(std::move(terrain)),
      obstacles_(with_kerbs(walls_, islands_)) {}

World3d::World3d(const Scene& scene, const Terrain& terrain)
    : World3d(scene.world, islands_of(scene), scene.crowns, terrain) {}

Echo World3d::cast(const Vector3& origin, const Vector3& direction, const Movers& movers, double range_max_m) const {
    const double over_ground = square_root(square(direction.x) + square(direction.y));
    const SinCos azimuth{.sin = direction.y / over_ground, .cos = direction.x / over_ground};
    const Point from{origin.x, origin.y};
    const Way way(terrain_, origin, azimuth, direction.z / over_ground);
    double way_m = range_max_m * over_ground;
    Surface surface = Surface::kNothing;
    const auto meet = [&](double at_m, Surface what) {
        if (at_m < way_m) {
            way_m = at_m;
            surface = what;
        }
    };
    // A ray that passes above a wall rises, and passes above all others behind it.
    const double wall_m = walls_.cast(from, azimuth, way_m);
    if (wall_m < way_m && way.above_m(wall_m) <= kWallHeight_m) {
        meet(wall_m, Surface::kWall);
    }
    for (const Circle& person : movers.legs) {
        const double at_m = cast_on_circle(from, azimuth, person);
        if (at_m < way_m && way.above_m(at_m) <= kPersonHeight_m) {
            meet(at_m, Surface::kPerson);
        }
    }
    for (const Box& car : movers.cars) {
        const Part part = part_over(from, azimuth, car);
        if (!part.empty() && part.from_m < way_m) {
            meet(way.down_to(car.height_m, part), Surface::kCar);
        }
    }
    for (const Crown& crown : crowns_) {
        const Part part = part_over(from, azimuth, crown.circle);
        if (!part.empty() && part.from_m < way_m) {
            meet(meet_crown(way, part, crown), Surface::kCrown);
        }
    }
    for (const Island& island : islands_) {
        const Part part = part_over(from, azimuth, island);
        if (!part.empty() && part.from_m < way_m) {
            meet(way.down_to(kKerbHeight_m, part), Surface::kKerb);
        }
    }
    meet(way.down_to(0.0, {.from_m = 0.0, .to_m = way_m}), Surface::kGround);
    return surface == Surface::kNothing ? Echo{} : Echo{way_m / over_ground, surface};
}

}  // namespace crspf::sim
