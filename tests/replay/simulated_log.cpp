#include "tests/replay/simulated_log.hpp"

#include <string_view>

#include "tools/sim/lidar_model.hpp"
#include "tools/sim/log_writer.hpp"
#include "tools/sim/scene.hpp"
#include "tools/sim/simulation.hpp"

namespace crspf::test {

SimulatedRun simulate_office(LogFormat format, std::optional<double> duration_s) {
    sim::SimulationParams params;
    params.lidar = sim::lidar_model("urg");
    params.duration_s = duration_s;
    const auto writer =
        format == LogFormat::kCarmen ? sim::carmen_writer(params.lidar, params.P_base_lidar) : sim::urg_dat_writer();
    SimulatedRun run;
    run.truth =
        sim::simulate(
            sim::make_scene("office"), params, *writer, [&](std::string_view text) { run.log += text; }, [](double) {})
            .truth;
    run.config.slam.lidar.range_min_m = params.lidar.range_min_m;
    run.config.slam.lidar.range_max_m = params.lidar.range_max_m;
    run.config.slam.lidar.time_per_beam_s = params.lidar.time_per_beam_s();
    run.config.slam.odometry.wheel_span_m = params.robot.wheel_span_m;
    run.config.wheels.counts_per_turn = params.robot.counts_per_turn;
    run.config.wheels.wheel_radius_m = params.robot.wheel_radius_m;
    return run;
}

}  // namespace crspf::test
