#include "tools/sim/sample_drive.hpp"

#include <optional>
#include <string>
#include <string_view>
#include <utility>

#include "platform/capture/scan_beams.hpp"
#include "tools/sim/log_writer.hpp"

namespace crspf::sim {
namespace {

constexpr Stamp stamp_of(std::int64_t us) {
    return {us * 1000};
}

/// Takes the place of a log.
class StepMaker final : public LogWriter {
 public:
    StepMaker(const LidarModel& model, const LidarParams& lidar, const std::function<void(SampleDrive::Step&)>& take)
        : model_(model), lidar_(lidar), take_(take) {}

    void odometry(const OdometryRecord& record, std::string& /*text*/) override {
        if (P_odom_base_) {
            step_.motions.push_back(
                {.stamp = stamp_of(record.stamp_us), .P_previous_base = inverse(*P_odom_base_) * record.P_odom_base});
        }
        P_odom_base_ = record.P_odom_base;
        newest_ = stamp_of(record.stamp_us);
    }

    void scan(const ScanRecord& record, std::string& /*text*/) override {
        Scan& scan = step_.scan;
        scan.count = model_.beams;
        for (std::size_t i = 0; i < record.range_mm.size(); ++i) {
            set_beam(scan, i, static_cast<float>(record.range_mm[i]) * 1e-3F, lidar_);
        }
        finish_scan(scan, model_.angle_min_rad, model_.increment_rad, model_.time_per_beam_s(), lidar_);
        scan.stamp = stamp_of(record.stamp_us);
        take_(step_);
        step_ = {};
    }

    [[nodiscard]] Stamp newest() const { return newest_; }

 private:
    const LidarModel& model_;
    const LidarParams& lidar_;
    const std::function<void(SampleDrive::Step&)>& take_;
    std::optional<Pose2> P_odom_base_;
    Stamp newest_;
    SampleDrive::Step step_;
};

}  // namespace

LidarParams told_lidar(const SimulationParams& params) {
    LidarParams lidar;
    lidar.P_base_lidar = params.P_base_lidar;
    lidar.range_min_m = params.lidar.range_min_m;
    lidar.range_max_m = params.lidar.range_max_m;
    return lidar;
}

SampleDrive stream_drive(const Scene& scene, const SimulationParams& params,
                         const std::function<void(SampleDrive::Step&)>& take) {
    SampleDrive drive;
    drive.lidar = told_lidar(params);
    StepMaker maker(params.lidar, drive.lidar, take);
    const SimulationResult result = simulate(
        scene, params, maker, [](std::string_view) {}, [](double) {});
    drive.P_world_map = result.P_world_start;
    const Pose2 P_map_world = inverse(drive.P_world_map);
    drive.truth.reserve(result.truth.size());
    for (const TimedPose& pose : result.truth) {
        drive.truth.push_back(P_map_world * pose.P_map_base);
    }
    drive.length = maker.newest() - stamp_of(params.start_us);
    drive.driven_m = result.driven_m;
    drive.given_up = result.given_up;
    return drive;
}

SampleDrive record_drive(const Scene& scene, const SimulationParams& params) {
    std::vector<SampleDrive::Step> steps;
    SampleDrive drive = stream_drive(scene, params, [&](SampleDrive::Step& step) { steps.push_back(std::move(step)); });
    drive.steps = std::move(steps);
    return drive;
}

}  // namespace crspf::sim
