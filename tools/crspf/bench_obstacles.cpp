#include "tools/crspf/bench_obstacles.hpp"

#include <benchmark/benchmark.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <memory>
#include <span>

#include "core/base/trig.hpp"
#include "core/slam/obstacle_scan.hpp"
#include "drivers/velodyne/velodyne_models.hpp"
#include "tools/crspf/bench_velodyne.hpp"

namespace crspf::cli {
namespace {

constexpr double kTurn_s = 0.1;

/// A yard between walls, 24 m by 16 m, seen from a car's roof: every laser that looks down or level has a return.
std::unique_ptr<Cloud> yard(VelodyneModel model, const VelodyneCalibration& calibration, double height_m) {
    auto cloud = std::make_unique<Cloud>();
    cloud->lasers = traits_of(model).lasers;
    const VelodyneTraits& traits = traits_of(model);
    // A packet's 384 returns, so many of them a turn.
    cloud->columns = static_cast<std::uint32_t>(kTurn_s * 1e6 / traits.packet_us * 384.0 / cloud->lasers);
    cloud->complete = true;
    cloud->upward = lasers_upward(model, calibration);
    for (std::uint32_t c = 0; c < cloud->columns; ++c) {
        const double turned_rad = 2.0 * kPi * c / cloud->columns;
        cloud->azimuth_rad[c] = std::fmod(kPi + turned_rad, 2.0 * kPi);
        cloud->stamp[c] = Stamp{} + Duration::from_seconds(kTurn_s * c / cloud->columns);
        cloud->measured[c] = true;
        for (std::uint32_t l = 0; l < cloud->lasers; ++l) {
            const double left_rad = calibration[l].rotation_rad - cloud->azimuth_rad[c];
            const double x = std::cos(left_rad);
            const double y = std::sin(left_rad);
            const double rise = std::tan(calibration[l].vertical_rad);
            const double wall_m = std::min(12.0 / std::abs(x), 8.0 / std::abs(y));
            const double range_m = rise < 0.0 ? std::min(wall_m, height_m / -rise) : wall_m;
            const std::size_t at = cloud->at(c, l);
            cloud->x_m[at] = static_cast<float>(range_m * x);
            cloud->y_m[at] = static_cast<float>(range_m * y);
            cloud->z_m[at] = static_cast<float>(range_m * rise);
            cloud->beam[at] = Beam::kHit;
        }
    }
    return cloud;
}

void register_obstacles(const char* name, VelodyneModel model) {
    benchmark::RegisterBenchmark(name, [model](benchmark::State& state) {
        const VelodyneCalibration calibration = bench_calibration(model);
        const auto cloud = yard(model, calibration, ObstacleParams{}.lidar_height_m);
        const auto scanner = std::make_unique<ObstacleScanner>(ObstacleParams{}, LidarParams{});
        const AttitudeHistory level;
        const auto scan = std::make_unique<Scan>();
        for ([[maybe_unused]] auto _ : state) {
            benchmark::DoNotOptimize(scanner->scan(*cloud, level, *scan));
        }
        const auto beams = std::span(scan->beam).first(scan->count);
        if (!std::all_of(beams.begin(), beams.end(), [](Beam beam) { return beam == Beam::kHit; })) {
            state.SkipWithError("the walls were not found");
        }
        state.SetItemsProcessed(state.iterations());
    });
}

}  // namespace

void register_obstacle_cases() {
    // NOLINTBEGIN(clang-analyzer-cplusplus.NewDeleteLeaks): the library keeps and frees what is registered
    register_obstacles(kObstaclesVlp16, VelodyneModel::kVlp16);
    register_obstacles(kObstaclesHdl64e, VelodyneModel::kHdl64eS2);
    // NOLINTEND(clang-analyzer-cplusplus.NewDeleteLeaks)
}

}  // namespace crspf::cli
