// The service's status as diagnostics that ROS's tools and Foxglove show.
#pragma once

#include "tools/view/messages.hpp"

namespace crspf::view {

/// diagnostic_msgs/DiagnosticArray of a status document (docs/service.md), or of a replay's: sources, threads, pose,
/// map, output, as far as it has them.
[[nodiscard]] Json diagnostics_of(const StatusEvent& status);

}  // namespace crspf::view
