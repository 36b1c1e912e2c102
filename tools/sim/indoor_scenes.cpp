#include <vector>

#include "core/base/trig.hpp"
#include "tools/sim/built_in_scenes.hpp"
#include "tools/sim/drawing.hpp"

namespace crspf::sim {

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

// A corridor of 45 m x 2.4 m that leads from the west into a hall of 20 m x 15 m, and one of 25 m x 2.2 m that leaves
// the hall to the north; in the corridors nothing but closed doors, in the hall pillars, a counter, benches, plants.
Scene lobby() {
    constexpr double kDoor_m = 0.9;
    constexpr double kDepth_m = 0.08;
    Drawing d;
    d.wall_with_niches(0.0, 45.0, 0.0, {2.2, 7.4, 11.9, 18.8, 23.1, 30.6, 34.2, 41.0}, kDoor_m, -kDepth_m);
    d.wall_with_niches(0.0, 45.0, 2.4, {4.6, 9.3, 16.2, 21.0, 27.9, 37.3, 42.1}, kDoor_m, kDepth_m);
    d.line({{0.0, 0.0}, {0.0, 2.4}});
    d.line({{45.0, 0.0}, {45.0, -4.6}, {65.0, -4.6}, {65.0, 10.4}, {60.6, 10.4}});
    d.line({{45.0, 2.4}, {45.0, 10.4}, {58.4, 10.4}});
    d.wall_y_with_niches(10.4, 35.4, 58.4, {12.1, 17.5, 21.2, 28.8, 32.0}, kDoor_m, -kDepth_m);
    d.wall_y_with_niches(10.4, 35.4, 60.6, {14.6, 19.0, 26.3, 30.9}, kDoor_m, kDepth_m);
    d.line({{58.4, 35.4}, {60.6, 35.4}});

    for (const Point pillar :
         {Point{50.2, -1.6}, Point{50.2, 6.4}, Point{55.6, -1.6}, Point{55.6, 6.4}, Point{61.0, -1.6}}) {
        d.round(pillar, 0.3, 24);
    }
    d.box(62.0, 2.2, 62.7, 7.2);  // the counter
    d.box(62.7, 2.2, 65.0, 2.9);
    d.turned_box({52.8, 2.6}, 1.8, 0.5, 25.0);
    d.turned_box({58.2, 0.9}, 1.8, 0.5, 100.0);
    d.box(46.8, 9.8, 49.6, 10.4);
    d.box(53.0, -4.6, 54.8, -4.1);
    d.turned_box({63.3, -3.4}, 2.0, 0.5, -45.0);
    d.round({45.9, -3.7}, 0.45, 16);
    d.round({56.9, 9.5}, 0.35, 16);
    return finish(d, {.x_m = 1.0, .y_m = 1.2, .theta_rad = 0.0},
                  {{47.0, 0.8},
                   {58.0, -3.2},
                   {63.4, 0.4},
                   {63.6, 8.2},
                   {59.5, 34.4},
                   {59.5, 9.0},
                   {53.0, 8.6},
                   {47.4, 5.6},
                   {1.0, 1.2}});
}

// 4.57 m x 4.04 m, the size of the paper's arena for rescue robots: thin walls, five alleys by five, one way round and
// a dead end.
Scene arena() {
    constexpr double kThick_m = 0.03;
    static constexpr double kX_m[] = {0.0, 0.86, 1.78, 2.70, 3.64, 4.57};  // the walls' middles
    static constexpr double kY_m[] = {0.0, 0.80, 1.62, 2.42, 3.20, 4.04};
    Drawing d;
    d.box(kX_m[0], kY_m[0], kX_m[5], kY_m[5]);
    const auto along_x = [&d](int from, int to, int row) {
        d.box(kX_m[from], kY_m[row] - kThick_m / 2.0, kX_m[to], kY_m[row] + kThick_m / 2.0);
    };
    const auto along_y = [&d](int column, int from, int to) {
        d.box(kX_m[column] - kThick_m / 2.0, kY_m[from], kX_m[column] + kThick_m / 2.0, kY_m[to]);
    };
    along_x(1, 2, 1);
    along_x(0, 1, 2);
    along_x(3, 4, 2);
    along_x(1, 3, 3);
    along_x(4, 5, 3);
    along_x(3, 4, 4);
    along_y(1, 3, 4);
    along_y(2, 1, 3);
    along_y(2, 4, 5);
    along_y(3, 0, 2);
    along_y(3, 3, 4);
    along_y(4, 1, 2);
    const auto in = [](int column, int row) {
        return Point{(kX_m[column] + kX_m[column + 1]) / 2.0, (kY_m[row] + kY_m[row + 1]) / 2.0};
    };
    const Point start = in(0, 0);
    return finish(d, {.x_m = start.x_m, .y_m = start.y_m, .theta_rad = 0.0},
                  {in(2, 0), in(2, 2), in(4, 2), in(3, 1), in(4, 2), in(3, 3), in(4, 4), in(2, 4), in(1, 3), in(0, 4),
                   in(0, 2), in(1, 1), start});
}

}  // namespace crspf::sim
