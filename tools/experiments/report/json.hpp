// A report as JSON, for programs (docs/experiments.md has the schema).
#pragma once

#include <nlohmann/json.hpp>

#include "tools/experiments/report/report.hpp"

namespace crspf::experiments {

[[nodiscard]] nlohmann::ordered_json json_of(const Report& report);

}  // namespace crspf::experiments
