// A simulated drive as samples in memory, and its endless repetition, for measurements.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

#include "core/base/pose.hpp"
#include "core/base/samples.hpp"
#include "core/base/time.hpp"
#include "core/slam/pipeline.hpp"
#include "core/slam/slam_params.hpp"
#include "tools/sim/lidar_model.hpp"

namespace crspf::cli {

struct Drive {
    /// A scan and the odometry that came since the scan before.
    struct Step {
        std::vector<MotionSample> motions;
        Scan scan;
        Pose2 P_map_base;  ///< true pose at the first beam; the map frame is base_link at the start
    };
    LidarParams lidar;
    std::vector<Step> steps;
    Duration length;
};

/// The robot of `crspf sim` on its way through the simulated office.
[[nodiscard]] Drive drive_through_office(const sim::LidarModel& lidar, double seconds);

/// A lidar that looks all round, up to 10 m, and reads all beams of a scan at once.
[[nodiscard]] sim::LidarModel all_round_lidar(std::uint32_t beams);

/// Plays a drive to a pipeline lap by lap: time goes on, and the robot is put back to the start.
class Laps {
 public:
    explicit Laps(Drive drive);

    /// One lap. Returns how many of its scans were matched.
    std::uint64_t play();

    /// In a lap.
    [[nodiscard]] std::size_t scans() const { return drive_.steps.size(); }
    [[nodiscard]] Pipeline& pipeline() { return *pipeline_; }

 private:
    Drive drive_;
    std::unique_ptr<Pipeline> pipeline_;
};

}  // namespace crspf::cli
