// The scans of recorded runs, as points in base_link.
#pragma once

#include <filesystem>
#include <functional>
#include <vector>

#include "config/config.hpp"
#include "core/slam/scan_points.hpp"
#include "tools/eval/scan_alignment.hpp"

namespace crspf::eval {

struct LoggedScan {
    double stamp_s = 0.0;  ///< [s] exactly as the file has it; may run back
    ScanHits hits;
};

/// Calls `visit(stamp_s, points)` for the scans of logs that are parts of one run, in file order: those that a replay
/// gives a pose each. Mounting, range limits and de-skew (by the log's odometry) as a replay has them. Throws
/// InputError: a log that cannot be read, or no scan in any of them.
void for_each_scan(const std::vector<std::filesystem::path>& logs, const Config& config,
                   const std::function<void(double, const ScanPoints&)>& visit);

/// The same, kept.
[[nodiscard]] std::vector<LoggedScan> read_scans(const std::vector<std::filesystem::path>& logs, const Config& config);

}  // namespace crspf::eval
