// Simulated drives, and their endless repetition, for measurements.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>

#include "core/slam/pipeline.hpp"
#include "tools/sim/lidar_model.hpp"
#include "tools/sim/sample_drive.hpp"

namespace crspf::cli {

/// The robot of `crspf sim` on its way through the simulated office.
[[nodiscard]] sim::SampleDrive drive_through_office(const sim::LidarModel& lidar, double seconds);

/// Plays a drive to a pipeline lap by lap: time goes on, and the robot is put back to the start.
class Laps {
 public:
    explicit Laps(sim::SampleDrive drive);

    /// One lap. Returns how many of its scans were matched.
    std::uint64_t play();

    /// In a lap.
    [[nodiscard]] std::size_t scans() const { return drive_.steps.size(); }
    [[nodiscard]] Pipeline& pipeline() { return *pipeline_; }

 private:
    sim::SampleDrive drive_;
    std::unique_ptr<Pipeline> pipeline_;
};

}  // namespace crspf::cli
