// What the maker of the simulated robot would tell: its configuration file.
#pragma once

#include <string>

#include "tools/sim/simulation.hpp"

namespace crspf::cli {

/// @param dat_log the log is a .dat, whose reader takes its lines for written late
/// @param capture there is one: the sources and their signals are added
[[nodiscard]] std::string sim_config(const sim::SimulationParams& params, bool dat_log, bool capture);

}  // namespace crspf::cli
