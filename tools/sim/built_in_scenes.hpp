// The worlds that are drawn by hand; make_scene() knows their names.
#pragma once

#include "tools/sim/scene.hpp"

namespace crspf::sim {

[[nodiscard]] Scene office();
[[nodiscard]] Scene corridor();
[[nodiscard]] Scene meeting();
[[nodiscard]] Scene hall();
[[nodiscard]] Scene lobby();
[[nodiscard]] Scene arena();
[[nodiscard]] Scene field();
[[nodiscard]] Scene campus();
[[nodiscard]] Scene parking();

}  // namespace crspf::sim
