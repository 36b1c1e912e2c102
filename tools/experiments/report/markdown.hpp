// The parts of a report that go into other documents, as Markdown tables.
#pragma once

#include <string>

#include "tools/experiments/report/report.hpp"

namespace crspf::experiments {

/// The README's table, under a line that says which command made it, of which version and where.
[[nodiscard]] std::string headlines_of(const Report& report);

[[nodiscard]] std::string claims_of(const Report& report);

}  // namespace crspf::experiments
