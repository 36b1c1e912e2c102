// What most experiments do: drive a simulated robot, play the drive to the core, compare with the truth; the same with
// other seeds, on all processors.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "core/slam/pipeline.hpp"
#include "core/slam/slam_params.hpp"
#include "platform/files/grid_map.hpp"
#include "platform/files/trajectory.hpp"
#include "tools/experiments/report/report.hpp"
#include "tools/sim/sample_drive.hpp"
#include "tools/sim/simulation.hpp"

namespace crspf::experiments {

/// The paper's indoor robot: two wheels and a URG-04LX-UG01, 0.145 m ahead of the axle. Its odometry is 2 % too long,
/// its right wheel counts 0.2 % more than the left: 3.5 deg in 10 m.
[[nodiscard]] sim::SimulationParams urg_robot(std::uint64_t seed);

/// The defaults, with what a configuration tells of this robot's lidar.
[[nodiscard]] SlamParams params_for(const sim::SampleDrive& drive, std::uint64_t seed);

/// A drive as the core saw it.
struct Played {
    std::vector<Pose2> poses;     ///< P_map_base of each scan, as known at that moment
    std::vector<double> scan_ms;  ///< processor time of the core for each, the odometry before it included
    double resolution_m = 0.0;    ///< of the map
    std::unique_ptr<Pipeline> pipeline;
};

using OnResult = std::function<void(const sim::SampleDrive::Step&, const ScanResult&)>;

[[nodiscard]] Played play(const sim::SampleDrive& drive, const SlamParams& params, const OnResult& on_result = {});
/// The same to a pipeline that may know land already; `Played` holds none then.
[[nodiscard]] Played play_to(Pipeline& pipeline, const sim::SampleDrive& drive, const OnResult& on_result = {});

/// The same drive for an odometry in step with the filter: one motion from scan to scan, and nothing in between.
[[nodiscard]] sim::SampleDrive in_step(sim::SampleDrive drive);

/// How far the poses are from the truth. The map frame is that of the start, so nothing needs to be aligned.
struct DriveError {
    double rms_m = 0.0;
    double max_m = 0.0;
    double end_m = 0.0;
    double heading_max_deg = 0.0;
    /// More than 1 m off at some time: a robot would look for the next door in the wrong place.
    [[nodiscard]] bool failed() const { return max_m > 1.0; }
};
[[nodiscard]] DriveError error_of(const std::vector<Pose2>& poses, const std::vector<Pose2>& truth);
/// Of the odometry alone.
[[nodiscard]] DriveError odometry_error(const sim::SampleDrive& drive);

/// Over seeds.
struct Spread {
    double mean = 0.0;
    double worst = 0.0;  ///< the largest
};
[[nodiscard]] Spread spread_of(const std::vector<double>& values);
/// "0.134 (0.262)".
[[nodiscard]] std::string mean_and_worst(const std::vector<double>& values, int decimals);
/// Of one value at least; of an even number the upper of the middle two.
[[nodiscard]] double median_of(std::vector<double> values);

[[nodiscard]] GridMap map_of(const Played& played);
/// The map, and in it the way that was found.
[[nodiscard]] Picture map_picture(const Played& played, std::string caption);

/// Calls work(i) for i < count in as many threads as there are processors; tells `progress` as they end. Throws what
/// the first of them threw.
void in_parallel(std::size_t count, const std::function<void(double)>& progress,
                 const std::function<void(std::size_t)>& work);

/// Of this thread. [s]
[[nodiscard]] double thread_time_s();

/// A number with so many decimals; printf's rounding.
[[nodiscard]] std::string text_of(double value, int decimals);
/// "12.5 %" of 0.125.
[[nodiscard]] std::string percent_of(double share, int decimals);

}  // namespace crspf::experiments
