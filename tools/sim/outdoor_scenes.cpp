#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>
#include <vector>

#include "core/base/pose.hpp"
#include "core/base/trig.hpp"
#include "tools/sim/built_in_scenes.hpp"
#include "tools/sim/drawing.hpp"
#include "tools/sim/random.hpp"
#include "tools/sim/robot.hpp"

namespace crspf::sim {
namespace {

constexpr double kOutdoors_m = 0.1;  // of the true map
constexpr double kCarLength_m = 4.4;
constexpr double kCarWidth_m = 1.8;

/// Corners become bends that a car can drive.
std::vector<Point> with_bends(const std::vector<Point>& corners) {
    constexpr double kRadius_m = 7.0;
    constexpr double kStep_rad = 0.1;
    std::vector<Point> route{corners.front()};
    for (std::size_t i = 1; i + 1 < corners.size(); ++i) {
        const auto heading = [](Point a, Point b) { return arc_tan2(b.y_m - a.y_m, b.x_m - a.x_m); };
        const double before_rad = heading(corners[i - 1], corners[i]);
        const double turn_rad = wrap_angle(heading(corners[i], corners[i + 1]) - before_rad);
        const SinCos half = sin_cos(turn_rad / 2.0);
        const double radius_m = turn_rad > 0.0 ? kRadius_m : -kRadius_m;
        const Pose2 P_world_corner{.x_m = corners[i].x_m, .y_m = corners[i].y_m, .theta_rad = before_rad};
        const Pose2 begin = P_world_corner * Pose2{.x_m = -radius_m * half.sin / half.cos};
        for (int step = 0; step * kStep_rad < std::abs(turn_rad); ++step) {
            const double turned = step * kStep_rad;
            const Pose2 at = begin * arc(kRadius_m * turned, turn_rad > 0.0 ? turned : -turned);
            route.push_back({at.x_m, at.y_m});
        }
    }
    route.push_back(corners.back());
    return route;
}

}  // namespace

// 60 m x 44 m of grass between hedges: trees, poles, boulders, a barn.
Scene field() {
    Drawing d;
    d.box(0.0, 0.0, 60.0, 44.0);
    d.turned_box({44.0, 30.0}, 9.0, 6.0, 15.0);
    d.turned_box({12.0, 33.0}, 8.0, 0.6, -20.0);
    d.turned_box({31.0, 9.0}, 0.6, 9.0, 10.0);
    std::vector<Crown> crowns;
    for (const Point tree :
         {Point{9.0, 9.0}, Point{17.5, 14.0}, Point{24.0, 22.0}, Point{10.0, 22.5}, Point{21.0, 36.0},
          Point{33.0, 31.0}, Point{40.0, 17.0}, Point{52.0, 12.0}, Point{54.0, 36.0}, Point{43.0, 6.0}}) {
        d.round(tree, 0.22, 12);
        crowns.push_back({.circle = {.centre = tree, .radius_m = 1.8}, .low_m = 1.7, .high_m = 5.0});
    }
    for (const Point pole :
         {Point{15.0, 5.0}, Point{25.0, 5.0}, Point{36.0, 24.0}, Point{48.0, 21.0}, Point{30.0, 39.0}}) {
        d.round(pole, 0.07, 8);
    }
    d.round({18.0, 27.0}, 0.8, 9);
    d.round({27.5, 15.5}, 0.6, 7);
    d.round({49.5, 40.0}, 0.9, 9);
    d.round({37.0, 38.5}, 0.5, 7);
    Scene scene = finish(d, {.x_m = 5.0, .y_m = 15.0, .theta_rad = 0.0}, {});
    scene.crowns = std::move(crowns);
    scene.outdoors = true;
    return scene;
}

// 265 m x 215 m. A road winds through it eight times from side to side and leads back along the western fence, 2 km in
// all, between buildings of many sizes, with trees, lamps and parked cars along it.
Scene campus() {
    constexpr int kLegs = 8;
    constexpr double kApart_m = 26.0;  // from leg to leg
    constexpr double kWest_m = 40.0;
    constexpr double kEast_m = 240.0;
    constexpr double kBegin_m = 60.0;
    constexpr double kSouth_m = 15.0;
    constexpr double kBack_m = 14.0;  // the way back
    Random random(1, RandomStream::kScene);
    Drawing d;
    std::vector<Crown> crowns;
    const auto tree = [&](Point at) {
        d.round(at, random.uniform(0.12, 0.3), 10);
        crowns.push_back({.circle = {.centre = at, .radius_m = random.uniform(1.5, 2.5)}, .low_m = 2.2, .high_m = 6.0});
    };
    d.box(0.0, 0.0, 265.0, kSouth_m + kApart_m * (kLegs - 1) + 18.0);
    std::vector<Point> route;
    for (int leg = 0; leg < kLegs; ++leg) {
        const double y_m = kSouth_m + kApart_m * leg;
        const bool eastward = leg % 2 == 0;
        route.push_back({leg == 0 ? kBegin_m : eastward ? kWest_m : kEast_m, y_m});
        route.push_back({eastward ? kEast_m : kWest_m, y_m});
        // Lamps and trees on one side, parked cars on the other.
        double along_m = kWest_m + 8.0;
        while (along_m < kEast_m - 10.0) {
            if (random.uniform() < 0.6) {
                tree({along_m, y_m + random.uniform(5.5, 6.5)});
            } else {
                d.round({along_m, y_m + 5.2}, 0.09, 8);
            }
            if (random.uniform() < 0.6) {
                // One after the other: in which order arguments are evaluated is the compiler's choice.
                const double turn_deg = random.uniform(-4.0, 4.0);
                const double x_m = along_m + random.uniform(-2.0, 2.0);
                d.turned_box({x_m, y_m - 5.0}, kCarLength_m, kCarWidth_m, turn_deg);
            }
            along_m += random.uniform(9.0, 17.0);
        }
        if (leg + 1 == kLegs) {
            break;
        }
        // The buildings between this leg and the next; those at one end close the row but for the road.
        const double from_m = eastward ? kBack_m + 9.0 : kWest_m + 13.0;
        const double to_m = eastward ? kEast_m - 13.0 : 256.0;
        for (double x_m = from_m; x_m < to_m - 6.0;) {
            const double end_m = std::min(x_m + random.uniform(10.0, 32.0), to_m);
            const double low_m = y_m + random.uniform(8.0, 9.5);
            const double high_m = y_m + kApart_m - random.uniform(7.5, 9.0);
            d.box(x_m, low_m, end_m, high_m);
            if (random.uniform() < 0.5) {  // a porch
                const double porch_m = random.uniform(x_m + 1.0, std::max(end_m - 4.0, x_m + 1.5));
                d.box(porch_m, low_m - 1.2, std::min(porch_m + 3.0, end_m), low_m);
            }
            x_m = end_m + random.uniform(2.5, 7.0);
        }
    }
    // A wall with openings between the way back and the turns in the west; trees along the fence.
    const double north_m = route.back().y_m;
    double y_m = kSouth_m + 8.0;
    while (y_m < north_m - 10.0) {
        d.box(kBack_m + 7.0, y_m, kBack_m + 7.5, y_m + random.uniform(5.0, 9.0));
        tree({kBack_m - 7.0, y_m + random.uniform(0.0, 5.0)});
        y_m += random.uniform(12.0, 16.0);
    }
    route.push_back({kBack_m, north_m});
    route.push_back({kBack_m, kSouth_m});
    route.push_back({kBegin_m, kSouth_m});
    Scene scene = finish(d, {.x_m = kBegin_m, .y_m = kSouth_m, .theta_rad = 0.0}, {}, kOutdoors_m);
    scene.crowns = std::move(crowns);
    scene.outdoors = true;
    scene.route = with_bends(route);
    return scene;
}

// 72 m x 50 m: four rows of bays, most of them taken, round which the aisles lead; a hut, lamps, two trees.
Scene parking() {
    Random random(2, RandomStream::kScene);
    Drawing d;
    d.box(0.0, 0.0, 72.0, 50.0);
    constexpr double kBay_m = 2.6;
    for (const double y_m : {3.0, 18.5, 23.5, 39.0}) {
        for (int bay = 0; bay < 17; ++bay) {
            const double x_m = 14.0 + kBay_m * bay;
            if (random.uniform() < 0.7) {
                const double turn_deg = 90.0 + random.uniform(-3.0, 3.0);
                d.turned_box({x_m + random.uniform(-0.2, 0.2), y_m + random.uniform(-0.3, 0.3)}, kCarLength_m,
                             kCarWidth_m, turn_deg);
            }
        }
    }
    d.box(64.0, 0.0, 72.0, 5.0);
    d.box(0.0, 44.0, 9.0, 50.0);
    for (const Point lamp : {Point{12.0, 21.0}, Point{36.0, 21.0}, Point{60.0, 21.0}, Point{36.0, 45.5}}) {
        d.round(lamp, 0.1, 8);
    }
    std::vector<Crown> crowns;
    for (const Point tree : {Point{3.0, 21.0}, Point{69.0, 30.0}}) {
        d.round(tree, 0.2, 10);
        crowns.push_back({.circle = {.centre = tree, .radius_m = 2.0}, .low_m = 2.2, .high_m = 6.0});
    }
    Scene scene = finish(d, {.x_m = 20.0, .y_m = 10.5, .theta_rad = 0.0}, {}, kOutdoors_m);
    scene.crowns = std::move(crowns);
    scene.outdoors = true;
    scene.route = with_bends({{20.0, 10.5}, {64.5, 10.5}, {64.5, 31.0}, {8.0, 31.0}, {8.0, 10.5}, {20.0, 10.5}});
    return scene;
}

}  // namespace crspf::sim
