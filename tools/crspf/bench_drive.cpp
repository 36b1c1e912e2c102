#include "tools/crspf/bench_drive.hpp"

#include <optional>
#include <string>
#include <string_view>
#include <utility>

#include "platform/capture/scan_beams.hpp"
#include "tools/sim/log_writer.hpp"
#include "tools/sim/scene.hpp"
#include "tools/sim/simulation.hpp"

namespace crspf::cli {
namespace {

constexpr Stamp stamp_of(std::int64_t us) {
    return {us * 1000};
}

/// Takes the place of a log.
class DriveRecorder final : public sim::LogWriter {
 public:
    DriveRecorder(const sim::LidarModel& model, Drive& drive) : model_(model), drive_(drive) {}

    void odometry(const sim::OdometryRecord& record, std::string& /*text*/) override {
        if (P_odom_base_) {
            step_.motions.push_back(
                {.stamp = stamp_of(record.stamp_us), .P_previous_base = inverse(*P_odom_base_) * record.P_odom_base});
        }
        P_odom_base_ = record.P_odom_base;
        drive_.length = stamp_of(record.stamp_us) - Stamp{};
    }

    void scan(const sim::ScanRecord& record, std::string& /*text*/) override {
        Scan& scan = step_.scan;
        scan.count = model_.beams;
        for (std::size_t i = 0; i < record.range_mm.size(); ++i) {
            set_beam(scan, i, static_cast<float>(record.range_mm[i]) * 1e-3F, drive_.lidar);
        }
        finish_scan(scan, model_.angle_min_rad, model_.increment_rad, model_.time_per_beam_s(), drive_.lidar);
        scan.stamp = stamp_of(record.stamp_us);
        drive_.steps.push_back(std::exchange(step_, {}));
    }

 private:
    const sim::LidarModel& model_;
    Drive& drive_;
    std::optional<Pose2> P_odom_base_;
    Drive::Step step_;
};

}  // namespace

sim::LidarModel all_round_lidar(std::uint32_t beams) {
    return {.name = "all round",
            .beams = beams,
            .angle_min_rad = -kPi,
            .increment_rad = 2.0 * kPi / beams,
            .revolution_s = 0.0,
            .scan_rate_hz = 10.0,
            .range_min_m = 0.05,
            .range_max_m = 10.0,
            .no_return_m = 0.0,
            .noise_m = 0.01,
            .noise_fraction = 0.0,
            .dropout = 0.0};
}

Drive drive_through_office(const sim::LidarModel& lidar, double seconds) {
    const sim::Scene scene = sim::make_scene("office");
    sim::SimulationParams params;
    params.lidar = lidar;
    params.duration_s = seconds;
    Drive drive;
    drive.lidar.range_min_m = lidar.range_min_m;
    drive.lidar.range_max_m = lidar.range_max_m;
    DriveRecorder recorder(lidar, drive);
    const sim::SimulationResult result = sim::simulate(
        scene, params, recorder, [](std::string_view) {}, [](double) {});
    const Pose2 P_map_world = inverse(scene.P_world_start);
    for (std::size_t i = 0; i < drive.steps.size(); ++i) {
        drive.steps[i].P_map_base = P_map_world * result.truth[i].P_map_base;
    }
    return drive;
}

Laps::Laps(Drive drive) : drive_(std::move(drive)) {
    SlamParams params;
    params.lidar = drive_.lidar;
    pipeline_ = std::make_unique<Pipeline>(params);
}

std::uint64_t Laps::play() {
    const std::uint64_t matched_before = pipeline_->counters().matched;
    pipeline_->set_pose({});
    for (Drive::Step& step : drive_.steps) {
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
