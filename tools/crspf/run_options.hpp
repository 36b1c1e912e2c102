// What the commands that play recordings have in common: which run, and what they say about it in the terminal.
#pragma once

#include <CLI/CLI.hpp>
#include <cstdint>
#include <string>
#include <vector>

#include "platform/capture/log_reader.hpp"
#include "tools/crspf/replay_job.hpp"

namespace crspf::cli {

struct RunOptions {
    std::vector<std::string> inputs;
    std::string config;
    std::string localize;
    std::vector<double> initial_pose;
};

/// INPUT, --config, --localize and --initial-pose. `options` has to outlive the command.
void add_run_options(CLI::App& command, RunOptions& options);
/// Throws InputError for a configuration that cannot be used.
[[nodiscard]] ReplayJob job_of(const RunOptions& options);

/// How far it is, on standard error, where that is a terminal; gone with this object.
class ProgressBar {
 public:
    ProgressBar();
    ProgressBar(const ProgressBar&) = delete;
    ProgressBar& operator=(const ProgressBar&) = delete;
    ~ProgressBar();

    /// @param share 0 to 1
    void show(double share, std::uint64_t scans) const;

 private:
    bool terminal_;
};

/// Of damage and repaired stamps, if there were any.
void warn(const LogCounts& log);
/// Of writes that the map refused, if there were any.
void warn_of_map(std::uint64_t refused);
void print_sources(const std::vector<SourceReport>& sources);

}  // namespace crspf::cli
