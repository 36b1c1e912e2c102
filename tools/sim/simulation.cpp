#include "tools/sim/simulation.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <string>
#include <utility>

#include "core/base/trig.hpp"
#include "platform/files/input_error.hpp"
#include "tools/sim/driver.hpp"
#include "tools/sim/nav_grid.hpp"
#include "tools/sim/people.hpp"

namespace crspf::sim {
namespace {

constexpr std::uint64_t kTourStream = 4;
constexpr double kStepMax_s = 0.02;
constexpr double kFloorMargin_m = 0.05;  // planned ways keep this much more than the body's radius from the walls
constexpr double kPathStep_m = 0.1;

std::int64_t to_us(double seconds) {
    return static_cast<std::int64_t>(std::floor(seconds * 1e6 + 0.5));
}

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

void check_path(const std::vector<Point>& path, const World& world, double radius_m) {
    for (const Point p : path) {
        const bool inside = p.x_m > world.lower().x_m && p.x_m < world.upper().x_m && p.y_m > world.lower().y_m &&
                            p.y_m < world.upper().y_m;
        if (!inside || world.clearance(p, radius_m) < radius_m) {
            char text[160];
            std::snprintf(text, sizeof text,
                          "--path: at %.2f %.2f the robot (radius %.2f m) would touch a wall; lead the path round it",
                          p.x_m, p.y_m, radius_m);
            throw InputError(text);
        }
    }
}

Driver make_driver(const Scene& scene, const NavGrid& floor, const SimulationParams& params, std::vector<Point> path) {
    if (!path.empty()) {
        return {scene.world, floor, params.robot, std::move(path)};
    }
    std::vector<Point> places = scene.tour;
    if (places.empty()) {
        Random random(params.seed, kTourStream);
        places = floor.spread_places(params.places, random);
        places.push_back({scene.P_world_start.x_m, scene.P_world_start.y_m});
    }
    return {scene.world, floor, params.robot, std::move(places),
            params.duration_s.has_value() || params.distance_m.has_value()};
}

// Turns the lidar's mirror through the steps of the simulation.
class Sweeper {
 public:
    Sweeper(const Scene& scene, const SimulationParams& params)
        : world_(&scene.world),
          lidar_(params.lidar, params.seed),
          P_base_lidar_(params.P_base_lidar),
          time_per_beam_s_(params.lidar.time_per_beam_s()) {}

    /// Measures the beams that fall into the step [start_s, start_s + length_s).
    void advance(const Motion& motion, double start_s, double length_s, const std::vector<Circle>& legs) {
        for (;;) {
            const double scan_s = static_cast<double>(stamp_us_) * 1e-6;
            const double into_step_s = scan_s + beam_ * time_per_beam_s_ - start_s;
            if (into_step_s >= length_s) {
                return;
            }
            const Pose2 P_world_base = motion.pose_at(into_step_s);
            if (beam_ == 0) {
                truth_.push_back({.stamp_s = scan_s, .P_map_base = P_world_base});
                scan_ = {.stamp_us = stamp_us_,
                         .counts = motion.counts_at(into_step_s),
                         .range_mm = std::vector<int>(lidar_.model().beams)};
            }
            scan_.range_mm[beam_] = lidar_.read_mm(*world_, legs, P_world_base * P_base_lidar_, beam_);
            if (++beam_ == lidar_.model().beams) {
                finished_.push_back(std::move(scan_));
                beam_ = 0;
                stamp_us_ = to_us(static_cast<double>(++scans_) / lidar_.model().scan_rate_hz);
            }
        }
    }

    /// Scans whose sweep is over, oldest first; the caller takes them.
    std::vector<ScanRecord> take_finished() { return std::exchange(finished_, {}); }

    /// One for each finished scan.
    [[nodiscard]] std::vector<TimedPose> truth() const { return {truth_.begin(), truth_.begin() + scans_}; }

 private:
    const World* world_;
    Lidar lidar_;
    Pose2 P_base_lidar_;
    double time_per_beam_s_;
    std::int64_t scans_ = 0;     ///< finished
    std::int64_t stamp_us_ = 0;  ///< of the present scan
    std::uint32_t beam_ = 0;     ///< next to be measured
    ScanRecord scan_;
    std::vector<ScanRecord> finished_;
    std::vector<TimedPose> truth_;
};

}  // namespace

SimulationResult simulate(const Scene& scene, const SimulationParams& params, LogWriter& writer,
                          const std::function<void(std::string_view)>& write,
                          const std::function<void(double)>& progress) {
    const bool given_path = params.path.size() > 1;
    Pose2 P_world_start = scene.P_world_start;
    std::vector<Point> path;
    if (given_path) {
        path = densify(params.path);
        check_path(path, scene.world, params.robot.radius_m);
        P_world_start = {.x_m = path[0].x_m,
                         .y_m = path[0].y_m,
                         .theta_rad = arc_tan2(path[1].y_m - path[0].y_m, path[1].x_m - path[0].x_m)};
    }
    const double margin_m = given_path ? 0.0 : kFloorMargin_m;
    const NavGrid floor(scene.world, {P_world_start.x_m, P_world_start.y_m}, params.robot.radius_m + margin_m);
    Driver driver = make_driver(scene, floor, params, std::move(path));
    Robot robot(params.robot, P_world_start, params.seed);
    WheelOdometer odometer(params.robot);
    People people(floor, params.people, {P_world_start.x_m, P_world_start.y_m}, params.seed);
    Sweeper sweeper(scene, params);

    const double odometry_s = 1.0 / params.odometry_rate_hz;
    const int steps_per_tick = std::max(1, static_cast<int>(std::ceil(odometry_s / kStepMax_s - 1e-9)));
    const double step_s = odometry_s / steps_per_tick;
    const bool limited = params.duration_s.has_value() || params.distance_m.has_value();
    const auto share_of_limit = [&](double now_s) {
        return std::max(params.duration_s ? now_s / *params.duration_s : 0.0,
                        params.distance_m ? robot.driven_m() / *params.distance_m : 0.0);
    };

    std::string text;
    writer.odometry({.stamp_us = 0, .P_odom_base = {}, .speed_mps = 0.0, .turn_rate_radps = 0.0}, text);
    double now_s = 0.0;
    for (std::int64_t tick = 1; !driver.finished() && share_of_limit(now_s) < 1.0; ++tick) {
        EncoderCounts counts;
        for (int step = 0; step < steps_per_tick; ++step) {
            const double start_s = static_cast<double>(tick - 1) * odometry_s + step * step_s;
            const Command command = driver.command(robot, people.bodies(), step_s);
            const Motion motion = robot.advance(command, step_s);
            people.advance(step_s, {.centre = {robot.pose().x_m, robot.pose().y_m}, .radius_m = params.robot.radius_m});
            sweeper.advance(motion, start_s, step_s, people.legs());
            counts = motion.counts_at(step_s);
        }
        now_s = static_cast<double>(tick) * odometry_s;
        odometer.update(counts, odometry_s);
        writer.odometry({.stamp_us = to_us(now_s),
                         .P_odom_base = odometer.pose(),
                         .speed_mps = odometer.speed_mps(),
                         .turn_rate_radps = odometer.turn_rate_radps()},
                        text);
        for (const ScanRecord& scan : sweeper.take_finished()) {
            writer.scan(scan, text);
        }
        write(text);
        text.clear();
        progress(limited ? share_of_limit(now_s) : driver.progress());
    }
    return {
        .truth = sweeper.truth(), .simulated_s = now_s, .driven_m = robot.driven_m(), .given_up = driver.given_up()};
}

}  // namespace crspf::sim
