// A lidar that turns while the robot drives: each beam is measured from where the robot is at that moment.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "platform/files/trajectory.hpp"
#include "tools/sim/log_writer.hpp"
#include "tools/sim/robot.hpp"
#include "tools/sim/simulation.hpp"
#include "tools/sim/world.hpp"

namespace crspf::sim {

class Sweep {
 public:
    virtual ~Sweep() = default;
    /// Measures what falls into the step [start_s, start_s + length_s) of the drive.
    virtual void advance(const Motion& motion, double start_s, double length_s, const Movers& movers) = 0;
    /// Hands on what is finished, oldest first.
    virtual void deliver(LogWriter& writer, std::string& out) = 0;
    /// True poses of the robot: of a planar lidar at the first beam of each finished scan; of a spatial one at each
    /// passage of the cut behind, where the first beam of a planar scan out of the revolution was measured.
    [[nodiscard]] virtual std::vector<TimedPose> truth() const = 0;
};

/// `world` must outlive it.
[[nodiscard]] std::unique_ptr<Sweep> planar_sweep(const World& world, const SimulationParams& params);

}  // namespace crspf::sim
