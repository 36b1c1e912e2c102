// Fig. 19: a campus by an IMU and a car park by the wheels of a car, each with a Velodyne on the roof.
#include <vector>

#include "core/base/trig.hpp"
#include "tools/experiments/captured.hpp"
#include "tools/experiments/experiment.hpp"
#include "tools/experiments/runs.hpp"

namespace crspf::experiments {
namespace {

struct Variant {
    std::string name;
    cli::SimOptions options;
};

Findings drive_all(const Context& context, std::string caption, std::vector<Variant> variants,
                   std::vector<CapturedRun>& runs) {
    runs.resize(variants.size());
    in_parallel(variants.size(), context.progress, [&](std::size_t i) {
        cli::SimOptions& options = variants[i].options;
        options.out = (context.scratch / (options.world + std::to_string(i))).string();
        runs[i] = run_captured(options);
    });
    Findings findings;
    Table table = captured_table(std::move(caption));
    for (std::size_t i = 0; i < variants.size(); ++i) {
        add_row(table, variants[i].name, runs[i]);
        findings.figures[variants[i].name] = to_json(runs[i]);
    }
    findings.blocks.emplace_back(std::move(table));
    findings.blocks.emplace_back(map_picture(runs[0], "Map, " + variants[0].name + "."));
    return findings;
}

cli::SimOptions car_in(const char* world) {
    cli::SimOptions options;
    options.world = world;
    options.robot = "car";
    options.lidar = "velodyne";
    options.params.robot.odom_scale_error = 0.01;
    return options;
}

Verdict verdict_of(const std::vector<CapturedRun>& runs, double good_m) {
    Verdict verdict = Verdict::kHolds;
    for (const CapturedRun& run : runs) {
        if (run.error.position_m.max > 1.0) {
            return Verdict::kDoesNotHold;
        }
        verdict = run.error.position_m.rms > good_m ? Verdict::kPartly : verdict;
    }
    return verdict;
}

}  // namespace

Findings campus(const Context& context) {
    Variant plain{.name = "ten people", .options = car_in("campus")};
    plain.options.odometer = "imu";
    plain.options.gyro_bias_degps = 0.5;
    plain.options.params.odometry_rate_hz = 100.0;
    plain.options.params.people = 10;
    Variant busy = plain;
    busy.name = "ten people, twelve cars on the road";
    busy.options.params.cars = 12;
    std::vector<CapturedRun> runs;
    Findings findings = drive_all(context, "Error of the pose.", {plain, busy}, runs);
    findings.blocks.emplace(
        findings.blocks.begin(),
        Paragraph{"A lap of 2 km at 5 m/s between buildings, trees and parked cars; a VLP-16 on the roof, "
                  "an IMU of six axes whose rates are 0.5 deg/s wrong about each axis, a speed 1 % too "
                  "high. The map is that of the obstacles up to 60 m."});
    const std::string rms = text_of(runs[0].error.position_m.rms, 3) + " m";
    const std::string busy_rms = text_of(runs[1].error.position_m.rms, 3) + " m";
    findings.claims.push_back({.paper = "A part of a campus is mapped by an IMU and a 3D lidar (Fig. 19a).",
                               .measured = rms + " rms over " + text_of(runs[0].driven_m, 0) +
                                           " m, with twelve cars on the road " + busy_rms + ".",
                               .verdict = verdict_of(runs, 0.5)});
    findings.headlines.push_back(
        {.run = "campus, lap of 2 km, VLP-16, IMU with 0.5 deg/s bias, ten people, pose error, rms; with twelve cars",
         .result = rms + "; " + busy_rms});
    return findings;
}

Findings parking(const Context& context) {
    Variant plain{.name = "steering angle and speed", .options = car_in("parking")};
    plain.options.odometer = "steering";
    plain.options.speed_mps = 3.0;
    Variant busy = plain;
    busy.name = "the same, ten cars on the move";
    busy.options.params.cars = 10;
    std::vector<CapturedRun> runs;
    Findings findings = drive_all(context, "Error of the pose.", {plain, busy}, runs);
    findings.blocks.emplace(
        findings.blocks.begin(),
        Paragraph{"A lap of 142 m round four rows of bays at 3 m/s; a VLP-16 on the roof, speed and "
                  "steering angle on the bus, the speed 1 % too high."});
    const std::string rms = text_of(runs[0].error.position_m.rms, 3) + " m";
    const std::string busy_rms = text_of(runs[1].error.position_m.rms, 3) + " m";
    findings.claims.push_back(
        {.paper = "A parking lot is mapped by the wheels of a car (Fig. 19b), well enough to park.",
         .measured = rms + " rms, with ten cars on the move " + busy_rms + ".",
         .verdict = verdict_of(runs, 0.15)});
    findings.headlines.push_back(
        {.run = "car park, VLP-16, steering angle and speed, pose error, rms; with ten cars on the move",
         .result = rms + "; " + busy_rms});
    return findings;
}

}  // namespace crspf::experiments
