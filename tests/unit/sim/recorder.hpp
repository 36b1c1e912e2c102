// A log kept as records, and worlds small enough to reckon with.
#pragma once

#include <string>
#include <vector>

#include "core/base/pose.hpp"
#include "tools/sim/log_writer.hpp"
#include "tools/sim/map_walls.hpp"
#include "tools/sim/scene.hpp"
#include "tools/sim/simulation.hpp"
#include "tools/sim/world.hpp"

namespace crspf::test {

/// Keeps what a log writer is told.
class Recorder final : public sim::LogWriter {
 public:
    struct Scan {
        sim::ScanRecord record;
        std::int64_t newest_odometry_us = 0;  ///< when the scan came
    };

    void odometry(const sim::OdometryRecord& record, std::string& /*text*/) override { odometry_.push_back(record); }
    void scan(const sim::ScanRecord& record, std::string& /*text*/) override {
        scans_.push_back({record, odometry_.back().stamp_us});
    }

    [[nodiscard]] const std::vector<sim::OdometryRecord>& odometry() const { return odometry_; }
    [[nodiscard]] const std::vector<Scan>& scans() const { return scans_; }

 private:
    std::vector<sim::OdometryRecord> odometry_;
    std::vector<Scan> scans_;
};

inline std::vector<sim::Segment> box(double x0, double y0, double x1, double y1) {
    return {{{x0, y0}, {x1, y0}}, {{x1, y0}, {x1, y1}}, {{x1, y1}, {x0, y1}}, {{x0, y1}, {x0, y0}}};
}

/// An empty room with the robot 1 m from its left wall, facing right.
inline sim::Scene room(double length_m, double width_m) {
    sim::World world(box(0.0, 0.0, length_m, width_m));
    const Pose2 start{.x_m = 1.0, .y_m = width_m / 2.0, .theta_rad = 0.0};
    return {.world = world,
            .P_world_start = start,
            .tour = {},
            .truth = sim::rasterize(world, {start.x_m, start.y_m}, 0.05)};
}

/// A robot and a lidar that make no errors, apart from rounding.
inline sim::SimulationParams ideal() {
    sim::SimulationParams params;
    params.robot.slip = 0.0;
    params.robot.counts_per_turn = 1e6;
    params.lidar = sim::lidar_model("urg");
    params.lidar.noise_m = 0.0;
    params.lidar.noise_fraction = 0.0;
    params.lidar.dropout = 0.0;
    return params;
}

inline sim::SimulationResult run(const sim::Scene& scene, const sim::SimulationParams& params, sim::LogWriter& writer) {
    return sim::simulate(
        scene, params, writer, [](std::string_view) {}, [](double) {});
}

}  // namespace crspf::test
