// A simulation as `crspf sim` runs it: from its options to the files that it writes.
#pragma once

#include <cstddef>
#include <functional>
#include <optional>
#include <string>

#include "tools/crspf/sim_params.hpp"
#include "tools/sim/simulation.hpp"

namespace crspf::cli {

struct SimRun {
    sim::SimulationResult result;
    std::string log;                           ///< its name in the directory `out`; empty: the lidar has none
    std::optional<std::size_t> picture_pairs;  ///< in the folder `stereo`, where one was told
};

/// Simulates, and writes the log, truth.tum, world.pgm, world.yaml and config.toml into the directory `out`, the
/// capture and the pictures where the options say. `progress`, from 0 to 1, is told now and then. Throws InputError,
/// which names the option or the file, for what cannot be simulated or written.
SimRun run_sim(const SimOptions& options, const std::function<void(double share)>& progress);

}  // namespace crspf::cli
