// Much land for measurements: a map, and copies of it beside it.
#pragma once

#include <cstdint>

#include "core/slam/occupancy.hpp"
#include "core/slam/pipeline.hpp"

namespace crspf {

/// Loads so many copies of a map, each in another place, four in a row; its own place is left free. Throws
/// std::length_error where they do not fit.
void load_copies(const OccupancyMap& map, std::int32_t copies, Pipeline& pipeline);

}  // namespace crspf
