// A report as one HTML file that needs nothing else: no network, no script, no other file.
#pragma once

#include <string>

#include "tools/experiments/report/report.hpp"

namespace crspf::experiments {

/// Throws InputError for a picture without pixels or larger than kImageSideMax.
[[nodiscard]] std::string html_of(const Report& report);

}  // namespace crspf::experiments
