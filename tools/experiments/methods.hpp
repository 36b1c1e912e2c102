// The method and its alternatives as settings of the same code, played side by side on the same drives.
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "core/slam/slam_params.hpp"
#include "tools/experiments/experiment.hpp"
#include "tools/experiments/report/report.hpp"
#include "tools/experiments/runs.hpp"

namespace crspf::experiments {

struct Method {
    std::string name;
    std::function<void(SlamParams&)> change;  ///< of what is shipped
    bool in_step = false;                     ///< with an odometry in step with the filter
};

[[nodiscard]] Method as_shipped();
/// The paper's four ideas and nothing of what was added to them: feedback, critical rays (of weight 10), an odometry
/// out of step, error removal.
[[nodiscard]] Method paper_alone();
/// None of the four: a range and number of particles that stay, an odometry that tells one motion a scan, all rays
/// alike, a map in which nothing is removed. Kept from ours: the match field, the map's evidence, the thresholds.
[[nodiscard]] Method tinyslam_way();

/// What was added to the paper is switched off.
void remove_additions(SlamParams& params);
/// None of the paper's ideas that are settings of the core.
void remove_ideas(SlamParams& params);

/// A method's drives, one a seed.
struct MethodRuns {
    std::string name;
    std::vector<DriveError> errors;
    std::vector<double> scan_ms;  ///< mean of each drive

    [[nodiscard]] Spread rms_m() const;
    [[nodiscard]] std::size_t failed() const;
};

struct Comparison {
    std::vector<MethodRuns> methods;
    std::vector<DriveError> odometry;
    double driven_m = 0.0;  ///< of the first seed's drive
    std::size_t scans = 0;
};

/// Called with each played drive, from several threads at a time; of a method and seed once.
using OnPlayed =
    std::function<void(std::size_t method, std::size_t seed, const sim::SampleDrive& drive, const Played& played)>;

/// Each method on the drives of seeds 1 to `seeds`.
[[nodiscard]] Comparison compare(const Context& context, std::size_t seeds,
                                 const std::function<sim::SampleDrive(std::uint64_t seed)>& drive_of,
                                 const std::vector<Method>& methods, const OnPlayed& on_played = {});

/// Method, error, worst seed, failures, time.
[[nodiscard]] Table table_of(const Comparison& comparison, std::string caption);
[[nodiscard]] nlohmann::ordered_json to_json(const Comparison& comparison);

}  // namespace crspf::experiments
