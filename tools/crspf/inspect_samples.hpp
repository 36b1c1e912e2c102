// What the configured drivers understand of a recording, a line for each sample.
#pragma once

#include <filesystem>
#include <optional>
#include <vector>

#include "config/config.hpp"

namespace crspf::cli {

/// Prints the samples of recordings or logs as they would reach the core, then what each source counted.
void print_samples(const std::vector<std::filesystem::path>& files, const std::optional<Config>& config);

}  // namespace crspf::cli
