// `crspf calibrate` as a function: a recorded run in, what it tells of the vehicle out.
#pragma once

#include <cstddef>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "config/config.hpp"
#include "tools/calibrate/estimate.hpp"

namespace crspf {

struct CalibrateJob {
    std::vector<std::filesystem::path> logs;  ///< as ReplayJob::logs
    std::optional<Config> config;             ///< none: that of the recording, else the defaults
    /// Called now and then: the round that is played, counted from 1, and the share of it that is done.
    std::function<void(int, double)> progress;
};

/// Of a key of the configuration, in its unit.
struct Finding {
    std::string section;
    std::string key;
    std::string unit;
    double before = 0.0;
    double value = 0.0;
    double stddev = 0.0;
    bool found = false;    ///< the run tells it well enough to be written down
    std::string shown_by;  ///< the motion that does
};

struct CalibrateOutcome {
    std::vector<Finding> findings;
    int rounds = 0;          ///< played, each with what the one before found
    bool settled = true;     ///< the last one changed nothing that matters
    std::size_t pieces = 0;  ///< of the drive that were compared; 0 where there is no lidar
    double rest_m = 0.0;     ///< left over at the end of a piece: standard deviation
    double rest_rad = 0.0;
};

/// Throws InputError: as run_replay(); a log without wheels, steering or yaw rate, or with too short a drive.
[[nodiscard]] CalibrateOutcome run_calibration(const CalibrateJob& job);

/// What was found, as TOML to be put into the configuration.
[[nodiscard]] std::string fragment_of(const CalibrateOutcome& outcome);

}  // namespace crspf
