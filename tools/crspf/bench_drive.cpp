#include "tools/crspf/bench_drive.hpp"

#include <utility>

#include "core/slam/slam_params.hpp"
#include "tools/sim/scene.hpp"
#include "tools/sim/simulation.hpp"

namespace crspf::cli {

sim::SampleDrive drive_through_office(const sim::LidarModel& lidar, double seconds) {
    sim::SimulationParams params;
    params.lidar = lidar;
    params.duration_s = seconds;
    return sim::record_drive(sim::make_scene("office"), params);
}

Laps::Laps(sim::SampleDrive drive) : drive_(std::move(drive)) {
    SlamParams params;
    params.lidar = drive_.lidar;
    pipeline_ = std::make_unique<Pipeline>(params);
}

std::uint64_t Laps::play() {
    const std::uint64_t matched_before = pipeline_->counters().matched;
    pipeline_->set_pose({});
    for (sim::SampleDrive::Step& step : drive_.steps) {
        for (MotionSample& motion : step.motions) {
            pipeline_->on_motion(motion);
            motion.stamp = motion.stamp + drive_.length;  // for the next lap
        }
        pipeline_->on_scan(step.scan);
        step.scan.stamp = step.scan.stamp + drive_.length;
    }
    return pipeline_->counters().matched - matched_before;
}

}  // namespace crspf::cli
