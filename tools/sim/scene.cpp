#include "tools/sim/scene.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/base/trig.hpp"
#include "platform/files/input_error.hpp"
#include "tools/sim/map_walls.hpp"
#include "tools/sim/random.hpp"
#include "tools/sim/robot.hpp"

namespace crspf::sim {
namespace {

constexpr double kTruthResolution_m = 0.025;

// Draws walls. Where two solids overlap, the segments inside are out of everybody's sight.
class Drawing {
 public:
    void line(const std::vector<Point>& points) {
        for (std::size_t i = 1; i < points.size(); ++i) {
            walls_.push_back({points[i - 1], points[i]});
        }
    }

    /// Axis-aligned box between two corners.
    void box(double x0, double y0, double x1, double y1) { line({{x0, y0}, {x1, y0}, {x1, y1}, {x0, y1}, {x0, y0}}); }

    /// Box of the given size round its centre, turned.
    void turned_box(Point centre, double length_m, double width_m, double turn_deg) {
        const SinCos r = sin_cos(radians(turn_deg));
        const auto corner = [&](double u, double v) {
            const double x = u * length_m / 2.0;
            const double y = v * width_m / 2.0;
            return Point{centre.x_m + r.cos * x - r.sin * y, centre.y_m + r.sin * x + r.cos * y};
        };
        line({corner(-1, -1), corner(1, -1), corner(1, 1), corner(-1, 1), corner(-1, -1)});
    }

    /// Regular polygon with its corners on a circle.
    void round(Point centre, double radius_m, int sides) {
        std::vector<Point> corners;
        for (int i = 0; i <= sides; ++i) {
            const SinCos s = sin_cos(2.0 * kPi * (i % sides) / sides);
            corners.push_back({centre.x_m + radius_m * s.cos, centre.y_m + radius_m * s.sin});
        }
        line(corners);
    }

    /// A wall along x at height y with niches of the given depth (positive: towards +y) and width, starting at each of
    /// `niches`: closed doors, seen from the side where the depth leads away from.
    void wall_with_niches(double x0, double x1, double y, const std::vector<double>& niches, double width_m,
                          double depth_m) {
        std::vector<Point> points{{x0, y}};
        for (const double x : niches) {
            points.insert(points.end(), {{x, y}, {x, y + depth_m}, {x + width_m, y + depth_m}, {x + width_m, y}});
        }
        points.push_back({x1, y});
        line(points);
    }

    /// A thick wall along x round the line y, open at the doors [from, to], which are in ascending order.
    void thick_wall_x(double x0, double x1, double y, const std::vector<std::pair<double, double>>& doors) {
        for (const auto& [from, to] : doors) {
            box(x0, y - kThick_m / 2.0, from, y + kThick_m / 2.0);
            x0 = to;
        }
        box(x0, y - kThick_m / 2.0, x1, y + kThick_m / 2.0);
    }

    /// The same along y round the line x.
    void thick_wall_y(double y0, double y1, double x, const std::vector<std::pair<double, double>>& doors) {
        for (const auto& [from, to] : doors) {
            box(x - kThick_m / 2.0, y0, x + kThick_m / 2.0, from);
            y0 = to;
        }
        box(x - kThick_m / 2.0, y0, x + kThick_m / 2.0, y1);
    }

    /// Four legs.
    void table(Point centre, double length_m, double width_m) {
        for (const double u : {-0.5, 0.5}) {
            for (const double v : {-0.5, 0.5}) {
                turned_box({centre.x_m + u * length_m, centre.y_m + v * width_m}, 0.06, 0.06, 0.0);
            }
        }
    }

    [[nodiscard]] World world() const { return World(walls_); }

 private:
    static constexpr double kThick_m = 0.15;
    std::vector<Segment> walls_;
};

Scene finish(const Drawing& drawing, const Pose2& P_world_start, std::vector<Point> tour,
             double resolution_m = kTruthResolution_m) {
    World world = drawing.world();
    GridMap truth = rasterize(world, {P_world_start.x_m, P_world_start.y_m}, resolution_m);
    return {
        .world = std::move(world), .P_world_start = P_world_start, .tour = std::move(tour), .truth = std::move(truth)};
}

// 30 m x 20 m: a corridor along x, one that branches off to the north, nine rooms, some joined by second doors.
Scene office() {
    Drawing d;
    d.box(0.0, 0.0, 30.0, 20.0);
    d.thick_wall_x(0.0, 30.0, 8.9, {{2.0, 2.9}, {7.6, 8.5}, {13.2, 14.2}, {19.5, 20.4}, {26.0, 26.9}});
    d.thick_wall_x(0.0, 14.0, 11.1, {{4.2, 5.1}, {9.5, 10.4}});
    d.thick_wall_x(16.0, 30.0, 11.1, {{18.3, 19.2}, {25.1, 26.0}});
    d.thick_wall_y(11.1, 20.0, 14.0, {{16.5, 17.4}});
    d.thick_wall_y(11.1, 20.0, 16.0, {{14.8, 15.7}});
    d.thick_wall_y(0.0, 8.9, 5.2, {});
    d.thick_wall_y(0.0, 8.9, 11.0, {{4.0, 4.9}});
    d.thick_wall_y(0.0, 8.9, 17.3, {});
    d.thick_wall_y(0.0, 8.9, 23.8, {{6.0, 6.9}});
    d.thick_wall_y(11.1, 20.0, 7.2, {{17.6, 18.5}});
    d.thick_wall_y(11.1, 20.0, 22.4, {});

    // South rooms, from west to east.
    d.box(0.0, 3.0, 0.8, 4.8);
    d.box(3.4, 0.0, 5.0, 0.5);
    d.table({2.6, 4.6}, 1.6, 0.8);
    d.turned_box({2.4, 5.7}, 0.5, 0.45, 20.0);
    d.box(6.2, 1.6, 7.0, 3.2);
    d.box(7.0, 1.6, 7.8, 3.2);
    d.box(10.4, 6.0, 10.925, 8.0);
    d.turned_box({8.6, 5.4}, 0.5, 0.5, 35.0);
    d.round({14.2, 4.2}, 0.7, 24);
    d.round({12.9, 4.4}, 0.22, 12);
    d.round({15.3, 3.6}, 0.22, 12);
    d.box(11.6, 0.0, 15.8, 0.45);
    d.box(18.2, 1.2, 19.8, 2.0);
    d.box(21.4, 1.2, 23.0, 2.0);
    d.turned_box({19.2, 2.7}, 0.45, 0.45, 15.0);
    d.turned_box({22.0, 2.7}, 0.45, 0.45, -10.0);
    d.box(17.375, 5.0, 17.9, 7.0);
    d.turned_box({26.8, 3.6}, 2.4, 1.1, 25.0);
    d.box(29.4, 5.2, 30.0, 8.2);
    // North rooms.
    d.box(0.0, 19.4, 4.0, 20.0);
    d.table({3.2, 15.2}, 2.4, 1.0);
    d.turned_box({1.4, 15.0}, 0.5, 0.5, 40.0);
    d.box(8.4, 18.6, 10.0, 19.4);
    d.box(11.4, 18.6, 13.0, 19.4);
    d.turned_box({9.2, 17.9}, 0.45, 0.45, 30.0);
    d.box(11.0, 13.2, 11.8, 14.8);
    d.box(17.4, 19.2, 20.6, 20.0);
    d.table({19.2, 16.4}, 1.8, 0.9);
    d.box(21.7, 12.0, 22.325, 13.4);
    d.turned_box({26.4, 15.6}, 3.2, 1.2, -20.0);
    d.round({24.2, 18.6}, 0.35, 16);
    d.round({28.8, 12.6}, 0.35, 16);
    // Things that stand in the corridors.
    d.box(11.4, 8.975, 12.2, 9.3);
    d.box(22.0, 10.7, 23.2, 11.025);
    d.round({15.5, 19.5}, 0.25, 12);
    return finish(d, {.x_m = 1.0, .y_m = 10.0, .theta_rad = 0.0}, {});
}

// 80 m long, 2.2 m wide, and nothing but closed doors, 5 cm deep, to tell one place from the next.
Scene corridor() {
    constexpr double kLength_m = 80.0;
    constexpr double kWidth_m = 2.2;
    constexpr double kDoor_m = 0.9;
    constexpr double kDepth_m = 0.05;
    std::vector<double> right;
    std::vector<double> left;
    for (int i = 0; i < 20; ++i) {
        right.push_back(1.0 + 4.0 * i);
        left.push_back(2.6 + 3.9 * i);
    }
    Drawing d;
    d.wall_with_niches(0.0, kLength_m, 0.0, right, kDoor_m, -kDepth_m);
    d.wall_with_niches(0.0, kLength_m, kWidth_m, left, kDoor_m, kDepth_m);
    d.line({{0.0, 0.0}, {0.0, kWidth_m}});
    d.line({{kLength_m, 0.0}, {kLength_m, kWidth_m}});
    return finish(d, {.x_m = 1.0, .y_m = kWidth_m / 2.0, .theta_rad = 0.0},
                  {{kLength_m - 1.0, kWidth_m / 2.0}, {1.0, kWidth_m / 2.0}});
}

// 30 m x 10 m: a long table on trestles, chairs along it, door niches, a lectern.
Scene meeting() {
    Drawing d;
    d.wall_with_niches(0.0, 30.0, 0.0, {4.0, 14.5, 25.0}, 1.0, -0.12);
    d.wall_with_niches(0.0, 30.0, 10.0, {8.0, 21.0}, 1.8, 0.12);
    d.line({{0.0, 0.0}, {0.0, 10.0}});
    d.line({{30.0, 0.0}, {30.0, 10.0}});
    for (int i = 0; i < 10; ++i) {
        const double x = 6.0 + 2.0 * i;
        d.box(x - 0.05, 4.4, x + 0.05, 5.6);
    }
    for (int i = 0; i < 19; ++i) {
        const double x = 6.0 + 1.0 * i;
        // Nobody pushes his chair in as the others do.
        const double out = 0.1 * ((i * 7) % 5);
        d.round({x, 3.8 - out}, 0.24, 10);
        d.round({x + 0.1, 6.2 + 0.4 - out}, 0.24, 10);
    }
    d.turned_box({27.8, 5.0}, 0.9, 0.5, 90.0);
    d.box(0.0, 7.6, 0.5, 10.0);
    d.box(10.0, 9.6, 13.0, 10.0);
    return finish(d, {.x_m = 2.0, .y_m = 2.0, .theta_rad = 0.0}, {});
}

// 40 m x 25 m with pillars and counters, and a corridor that leads in from the west.
Scene hall() {
    Drawing d;
    d.line({{0.0, 13.2}, {0.0, 25.0}, {40.0, 25.0}, {40.0, 0.0}, {0.0, 0.0}, {0.0, 10.8}});
    d.line({{0.0, 13.2}, {-12.0, 13.2}, {-12.0, 10.8}, {0.0, 10.8}});
    for (const double x : {6.5, 13.5, 20.5, 27.5, 34.5}) {
        for (const double y : {6.0, 18.5}) {
            d.round({x, y}, 0.35, 24);
        }
    }
    d.box(17.0, 10.5, 24.0, 11.2);
    d.box(17.0, 11.2, 17.7, 14.0);
    d.box(23.3, 11.2, 24.0, 14.0);
    d.box(30.0, 24.0, 38.0, 25.0);
    d.box(5.0, 0.0, 12.0, 0.8);
    d.turned_box({36.0, 3.5}, 3.0, 0.6, 45.0);
    d.turned_box({31.5, 12.5}, 1.8, 0.5, 0.0);
    d.turned_box({9.5, 22.0}, 1.8, 0.5, 60.0);
    return finish(d, {.x_m = -11.0, .y_m = 12.0, .theta_rad = 0.0}, {});
}

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

Scene scene_of_map(const std::string& file) {
    GridMap map = read_grid_map(file);
    if (std::count(map.cells.begin(), map.cells.end(), GridCell::kFree) == 0) {
        throw InputError(file + ": the map has no free cell; check its thresholds and `negate`");
    }
    const Point start = most_open_place(map);
    World world(walls_of(map));
    return {.world = std::move(world),
            .P_world_start = {.x_m = start.x_m, .y_m = start.y_m, .theta_rad = 0.0},
            .tour = {},
            .truth = std::move(map)};
}

}  // namespace

Scene make_scene(const std::string& name_or_file) {
    if (name_or_file == "office") {
        return office();
    }
    if (name_or_file == "corridor") {
        return corridor();
    }
    if (name_or_file == "meeting") {
        return meeting();
    }
    if (name_or_file == "hall") {
        return hall();
    }
    if (name_or_file == "field") {
        return field();
    }
    if (name_or_file == "campus") {
        return campus();
    }
    if (name_or_file == "parking") {
        return parking();
    }
    if (!name_or_file.ends_with(".yaml") && !name_or_file.ends_with(".yml")) {
        throw InputError(
            "--world " + name_or_file +
            ": no such world; give office, corridor, meeting, hall, field, campus, parking or the .yaml file of a map");
    }
    return scene_of_map(name_or_file);
}

}  // namespace crspf::sim
