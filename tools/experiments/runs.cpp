#include "tools/experiments/runs.hpp"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstdio>
#include <ctime>
#include <exception>
#include <mutex>
#include <thread>
#include <utility>

#include "core/base/trig.hpp"
#include "platform/service/map_image.hpp"
#include "tools/sim/lidar_model.hpp"

namespace crspf::experiments {

sim::SimulationParams urg_robot(std::uint64_t seed) {
    sim::SimulationParams params;
    params.lidar = sim::lidar_model("urg");
    params.P_base_lidar = {.x_m = 0.145};
    params.robot.odom_scale_error = 0.02;
    params.robot.odom_bias = 0.002;
    params.seed = seed;
    return params;
}

SlamParams params_for(const sim::SampleDrive& drive, std::uint64_t seed) {
    SlamParams params;
    params.lidar = drive.lidar;
    params.particle_filter.seed = seed;
    return params;
}

double thread_time_s() {
    timespec t{};
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
    return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
}

Played play(const sim::SampleDrive& drive, const SlamParams& params, const OnResult& on_result) {
    auto pipeline = std::make_unique<Pipeline>(params);
    Played played = play_to(*pipeline, drive, on_result);
    played.pipeline = std::move(pipeline);
    played.resolution_m = params.map.resolution_m;
    return played;
}

Played play_to(Pipeline& pipeline, const sim::SampleDrive& drive, const OnResult& on_result) {
    Played played;
    played.poses.reserve(drive.steps.size());
    played.scan_ms.reserve(drive.steps.size());
    for (const sim::SampleDrive::Step& step : drive.steps) {
        const double start_s = thread_time_s();
        for (const MotionSample& motion : step.motions) {
            pipeline.on_motion(motion);
        }
        const ScanResult result = pipeline.on_scan(step.scan);
        played.scan_ms.push_back(1e3 * (thread_time_s() - start_s));
        played.poses.push_back(result.P_map_base);
        if (on_result) {
            on_result(step, result);
        }
    }
    return played;
}

sim::SampleDrive in_step(sim::SampleDrive drive) {
    for (sim::SampleDrive::Step& step : drive.steps) {
        if (step.motions.empty()) {
            continue;
        }
        MotionSample whole = step.motions.back();
        whole.P_previous_base = {};
        for (const MotionSample& motion : step.motions) {
            whole.P_previous_base = whole.P_previous_base * motion.P_previous_base;
        }
        step.motions = {whole};
    }
    return drive;
}

DriveError error_of(const std::vector<Pose2>& poses, const std::vector<Pose2>& truth) {
    DriveError error;
    double sum_m2 = 0.0;
    for (std::size_t i = 0; i < poses.size(); ++i) {
        const double off_m = std::hypot(poses[i].x_m - truth[i].x_m, poses[i].y_m - truth[i].y_m);
        const double turned_deg = degrees(std::abs(wrap_angle(poses[i].theta_rad - truth[i].theta_rad)));
        sum_m2 += off_m * off_m;
        error.max_m = std::max(error.max_m, off_m);
        error.heading_max_deg = std::max(error.heading_max_deg, turned_deg);
        error.end_m = off_m;
    }
    error.rms_m = poses.empty() ? 0.0 : std::sqrt(sum_m2 / static_cast<double>(poses.size()));
    return error;
}

DriveError odometry_error(const sim::SampleDrive& drive) {
    std::vector<Pose2> poses;
    Pose2 P_odom_base;
    for (const sim::SampleDrive::Step& step : drive.steps) {
        // The odometry at the scan's first beam: what came until then.
        Pose2 at_scan = P_odom_base;
        for (const MotionSample& motion : step.motions) {
            P_odom_base = P_odom_base * motion.P_previous_base;
            at_scan = motion.stamp > step.scan.stamp ? at_scan : P_odom_base;
        }
        poses.push_back(at_scan);
    }
    return error_of(poses, drive.truth);
}

Spread spread_of(const std::vector<double>& values) {
    Spread spread;
    for (const double value : values) {
        spread.mean += value / static_cast<double>(values.size());
        spread.worst = std::max(spread.worst, value);
    }
    return spread;
}

std::string mean_and_worst(const std::vector<double>& values, int decimals) {
    const Spread spread = spread_of(values);
    return text_of(spread.mean, decimals) + " (" + text_of(spread.worst, decimals) + ")";
}

double median_of(std::vector<double> values) {
    const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
    std::nth_element(values.begin(), middle, values.end());
    return *middle;
}

GridMap map_of(const Played& played) {
    return export_map(played.pipeline->map(), played.resolution_m);
}

Picture map_picture(const Played& played, std::string caption) {
    constexpr int kSide_px = 1400;
    std::vector<TimedPose> path;
    for (const Pose2& pose : played.poses) {
        path.push_back({.stamp_s = 0.0, .P_map_base = pose});
    }
    return {.caption = std::move(caption), .image = draw_map(map_of(played), path, kSide_px)};
}

void in_parallel(std::size_t count, const std::function<void(double)>& progress,
                 const std::function<void(std::size_t)>& work) {
    std::atomic<std::size_t> next = 0;
    std::mutex mutex;  // of what follows
    std::size_t done = 0;
    std::exception_ptr failure;
    const auto run = [&] {
        for (std::size_t i = next++; i < count; i = next++) {
            try {
                work(i);
            } catch (...) {
                const std::lock_guard lock(mutex);
                failure = failure ? failure : std::current_exception();
                next = count;
            }
            const std::lock_guard lock(mutex);
            progress(static_cast<double>(++done) / static_cast<double>(count));
        }
    };
    {
        const std::size_t threads = std::min<std::size_t>(count, std::max(1U, std::thread::hardware_concurrency()));
        std::vector<std::jthread> pool;
        for (std::size_t i = 0; i < threads; ++i) {
            pool.emplace_back(run);
        }
    }
    if (failure) {
        std::rethrow_exception(failure);
    }
}

std::string text_of(double value, int decimals) {
    char text[64];
    std::snprintf(text, sizeof text, "%.*f", decimals, value);
    return text;
}

std::string percent_of(double share, int decimals) {
    return text_of(100.0 * share, decimals) + " %";
}

}  // namespace crspf::experiments
