// A report in its files.
#pragma once

#include <filesystem>

#include "tools/experiments/report/report.hpp"

namespace crspf::experiments {

/// Creates the directory and tries whether it can be written to, so that this fails before the work and not after it.
void prepare_directory(const std::filesystem::path& directory);

/// report.html, report.json, headlines.md, claims.md, and charts and pictures that name a file; each whole or not at
/// all.
void write_report(const Report& report, const std::filesystem::path& directory);

}  // namespace crspf::experiments
