// A drive through the simulated office as a log on disk, with the truth.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "config/config.hpp"
#include "platform/files/trajectory.hpp"

namespace crspf::test {

enum class LogFormat : bool { kCarmen, kUrgDat };

struct SimulatedRun {
    std::string log;  ///< the file's content
    std::vector<TimedPose> truth;
    Config config;  ///< what the robot's maker would tell; all else as it is by default
};

/// The URG robot of `crspf sim`. Without a duration it makes its whole tour.
[[nodiscard]] SimulatedRun simulate_office(LogFormat format, std::optional<double> duration_s);

}  // namespace crspf::test
