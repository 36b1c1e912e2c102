// Whatever a run was recorded as, opened.
#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <vector>

#include "config/config.hpp"
#include "platform/capture/log_reader.hpp"

namespace crspf {

struct Run {
    /// One after the other, each with a time line of its own that begins at 0: logs are parts of a run, in order.
    /// Recordings of sensors are one part together.
    std::vector<std::unique_ptr<LogReader>> parts;
    Config config;  ///< that was used
};

/// @param config none: the one that the first recording carries, else the defaults
/// Throws InputError: what open_log() and open_capture_run() say; logs and recordings mixed; a carried configuration
/// that is not valid.
[[nodiscard]] Run open_run(const std::vector<std::filesystem::path>& files, const std::optional<Config>& config);

}  // namespace crspf
