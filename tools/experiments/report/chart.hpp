// A chart as SVG: valid XML, no scripts, nothing from outside.
#pragma once

#include <string>

#include "tools/experiments/report/report.hpp"

namespace crspf::experiments {

/// Drawn 900 px wide, on white. Values without a place (not finite; not above 0 on a log axis) are gaps.
[[nodiscard]] std::string svg_of(const Chart& chart);

}  // namespace crspf::experiments
