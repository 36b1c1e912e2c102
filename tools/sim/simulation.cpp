#include "tools/sim/simulation.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <memory>
#include <optional>
#include <string>
#include <utility>

#include "core/base/real.hpp"
#include "core/base/trig.hpp"
#include "platform/files/input_error.hpp"
#include "tools/sim/cars.hpp"
#include "tools/sim/driver.hpp"
#include "tools/sim/nav_grid.hpp"
#include "tools/sim/people.hpp"
#include "tools/sim/sweep.hpp"
#include "tools/sim/velodyne_sweep.hpp"
#include "tools/sim/world3d.hpp"

namespace crspf::sim {
namespace {

constexpr double kStepMax_s = 0.02;
constexpr double kFloorMargin_m = 0.05;  // planned ways keep this much more than the body's radius from the walls
constexpr double kPathStep_m = 0.1;

// Points at equal small steps along the way.
std::vector<Point> densify(const std::vector<Point>& path) {
    std::vector<Point> dense{path.front()};
    for (std::size_t i = 1; i < path.size(); ++i) {
        const Point a = path[i - 1];
        const Point b = path[i];
        const int steps = std::max(1, static_cast<int>(std::ceil(distance(a, b) / kPathStep_m)));
        for (int k = 1; k <= steps; ++k) {
            const double u = static_cast<double>(k) / steps;
            dense.push_back({a.x_m + u * (b.x_m - a.x_m), a.y_m + u * (b.y_m - a.y_m)});
        }
    }
    return dense;
}

// A route that leads round, as often as the drive lasts.
std::vector<Point> laps(const std::vector<Point>& route, const SimulationParams& params) {
    const double wanted_m =
        std::max(params.distance_m.value_or(0.0), params.duration_s.value_or(0.0) * params.robot.speed_mps);
    std::vector<Point> path = route;
    while (static_cast<double>(path.size()) * kPathStep_m < wanted_m) {
        path.insert(path.end(), route.begin() + 1, route.end());
    }
    return path;
}

void check_path(const std::vector<Point>& path, const World& world, double radius_m) {
    for (const Point p : path) {
        const bool inside = p.x_m > world.lower().x_m && p.x_m < world.upper().x_m && p.y_m > world.lower().y_m &&
                            p.y_m < world.upper().y_m;
        if (!inside || world.clearance(p, radius_m) < radius_m) {
            char text[160];
            std::snprintf(
                text, sizeof text,
                "--path: at %.2f %.2f the robot (radius %.2f m) would touch a wall or kerb; lead the path round it",
                p.x_m, p.y_m, radius_m);
            throw InputError(text);
        }
    }
}

// On the scene's own road, in the middle of which the robot drives.
Cars make_cars(const Scene& scene, const SimulationParams& params, Point start) {
    if (params.cars > 0 && (scene.route.empty() || params.path.size() > 1)) {
        throw InputError("--cars: they drive along a world's road; give --world campus or parking, and no --path");
    }
    return {scene.route, params.cars, start, params.seed};
}

Driver make_driver(const Scene& scene, const World& obstacles, const NavGrid& floor, const SimulationParams& params,
                   std::vector<Point> path) {
    if (!path.empty()) {
        return {obstacles, floor, params.robot, std::move(path)};
    }
    std::vector<Point> places = scene.tour;
    if (places.empty()) {
        Random random(params.seed, RandomStream::kTour);
        places = floor.spread_places(params.places, random);
        places.push_back({scene.P_world_start.x_m, scene.P_world_start.y_m});
    }
    return {obstacles, floor, params.robot, std::move(places),
            params.duration_s.has_value() || params.distance_m.has_value()};
}

}  // namespace

SimulationResult simulate(const Scene& scene, const SimulationParams& params, LogWriter& writer,
                          const std::function<void(std::string_view)>& write,
                          const std::function<void(double)>& progress) {
    std::optional<World3d> world3d;
    if (params.lidar.spatial()) {
        world3d.emplace(scene, Terrain(params.bumps_rad));
    }
    const World& obstacles = world3d ? world3d->obstacles() : scene.world;
    const bool limited = params.duration_s.has_value() || params.distance_m.has_value();
    const bool given_path = params.path.size() > 1 || !scene.route.empty();
    Pose2 P_world_start = scene.P_world_start;
    std::vector<Point> path;
    if (given_path) {
        path = params.path.size() > 1 ? densify(params.path) : laps(densify(scene.route), params);
        check_path(path, obstacles, params.robot.radius_m);
        P_world_start = {.x_m = path[0].x_m,
                         .y_m = path[0].y_m,
                         .theta_rad = arc_tan2(path[1].y_m - path[0].y_m, path[1].x_m - path[0].x_m)};
    }
    const double margin_m = given_path ? 0.0 : kFloorMargin_m;
    const NavGrid floor(obstacles, {P_world_start.x_m, P_world_start.y_m}, params.robot.radius_m + margin_m);
    Driver driver = make_driver(scene, obstacles, floor, params, std::move(path));
    Robot robot(params.robot, P_world_start, params.seed);
    WheelOdometer odometer(params.robot);
    People people(floor, params.people, {P_world_start.x_m, P_world_start.y_m}, params.seed);
    Cars cars = make_cars(scene, params, {P_world_start.x_m, P_world_start.y_m});
    const std::unique_ptr<Sweep> sweep = world3d ? velodyne_sweep(*world3d, params) : planar_sweep(scene.world, params);

    std::optional<StereoRig> stereo;
    if (params.stereo) {
        if (world3d) {
            throw InputError(
                "--stereo: the camera stands on level ground, which there is below planar lidars only; give --lidar "
                "lms5xx or another of them");
        }
        stereo.emplace(scene, *params.stereo, params.seed, params.start_us);
    }

    const auto frame_at = [&](const Pose2& P_world_base) {
        return world3d
                   ? frame_on(world3d->terrain(), P_world_base, params.robot.wheel_base_m, params.robot.wheel_span_m)
                   : level_frame(P_world_base);
    };
    ImuModel imu(frame_at(P_world_start));

    const double odometry_s = 1.0 / params.odometry_rate_hz;
    const int steps_per_tick = std::max(1, static_cast<int>(std::ceil(odometry_s / kStepMax_s - 1e-9)));
    const double step_s = odometry_s / steps_per_tick;
    const auto share_of_limit = [&](double now_s) {
        return std::max(params.duration_s ? now_s / *params.duration_s : 0.0,
                        params.distance_m ? robot.driven_m() / *params.distance_m : 0.0);
    };

    std::string text;
    writer.odometry({.stamp_us = params.start_us,
                     .P_odom_base = {},
                     .speed_mps = 0.0,
                     .turn_rate_radps = 0.0,
                     .counts = {},
                     .imu = {},
                     .curvature = 0.0},
                    text);
    double now_s = 0.0;
    for (std::int64_t tick = 1; !driver.finished() && share_of_limit(now_s) < 1.0; ++tick) {
        EncoderCounts counts;
        for (int step = 0; step < steps_per_tick; ++step) {
            const double start_s = static_cast<double>(tick - 1) * odometry_s + step * step_s;
            const Command command = driver.command(robot, people.bodies(), cars.discs(), step_s);
            const double level = world3d ? square_root(1.0 - square(frame_at(robot.pose()).x.z)) : 1.0;
            const Motion motion = robot.advance(command, step_s, level);
            const Circle body{.centre = {robot.pose().x_m, robot.pose().y_m}, .radius_m = params.robot.radius_m};
            people.advance(step_s, body);
            std::vector<Circle> others = people.bodies();
            others.push_back(body);
            cars.advance(step_s, others);
            const Movers movers{.legs = people.legs(), .cars = cars.boxes()};
            sweep->advance(motion, start_s, step_s, movers);
            if (stereo) {
                stereo->advance(motion, start_s, step_s, movers);
            }
            counts = motion.counts_at(step_s);
        }
        now_s = static_cast<double>(tick) * odometry_s;
        odometer.update(counts, odometry_s);
        writer.odometry({.stamp_us = params.start_us + to_us(now_s),
                         .P_odom_base = odometer.pose(),
                         .speed_mps = odometer.speed_mps(),
                         .turn_rate_radps = odometer.turn_rate_radps(),
                         .counts = counts,
                         .imu = imu.update(frame_at(robot.pose()), odometry_s),
                         .curvature = robot.curvature()},
                        text);
        sweep->deliver(writer, text);
        if (stereo) {
            stereo->deliver(writer, text);
        }
        write(text);
        text.clear();
        progress(limited ? share_of_limit(now_s) : driver.progress());
    }
    return {.P_world_start = P_world_start,
            .truth = sweep->truth(),
            .simulated_s = now_s,
            .driven_m = robot.driven_m(),
            .given_up = driver.given_up()};
}

}  // namespace crspf::sim
