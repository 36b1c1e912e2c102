#include "tools/crspf/bench_stereo.hpp"

#include <benchmark/benchmark.h>

#include <cstdint>
#include <memory>
#include <vector>

#include "drivers/stereo/stereo_odometry.hpp"
#include "tools/sim/scene.hpp"
#include "tools/sim/stereo_camera.hpp"

namespace crspf::cli {
namespace {

// The size of KITTI's pictures and their rate, from a car at 5 m/s.
constexpr int kWidth_px = 1226;
constexpr int kHeight_px = 370;
constexpr double kPeriod_s = 0.1;
constexpr double kStep_m = 0.5;
constexpr int kPairs = 10;

struct Approach {
    sim::StereoCameraParams camera{.camera = sim::usual_camera(kWidth_px, kHeight_px), .mounting = {.z_m = 1.5}};
    std::vector<sim::StereoPictures> pairs;

    Approach() {
        const sim::Scene scene = sim::make_scene("campus");
        sim::StereoCamera eyes(scene, camera, 1);
        for (int i = 0; i < kPairs; ++i) {
            const Pose2 ahead{.x_m = kStep_m * i, .y_m = 0.0, .theta_rad = 0.0};
            pairs.push_back(eyes.shoot(scene.P_world_start * ahead, {}));
        }
    }

    /// Odometry over all of them. How many told nothing.
    [[nodiscard]] std::uint64_t drive() const {
        StereoOdometry odometry(camera.camera, {.mounting = camera.mounting});
        StereoMotion motion;
        double now_s = 0.0;
        for (const sim::StereoPictures& pair : pairs) {
            now_s += kPeriod_s;
            benchmark::DoNotOptimize(odometry.add(Stamp{} + Duration::from_seconds(now_s),
                                                  {.left = pair.left.view(), .right = pair.right.view()}, motion));
        }
        return odometry.counters().blind;
    }
};

}  // namespace

void register_stereo_cases() {
    // NOLINTNEXTLINE(clang-analyzer-cplusplus.NewDeleteLeaks): the library keeps and frees what is registered
    benchmark::RegisterBenchmark(kStereoPair, [](benchmark::State& state) {
        static const Approach approach;
        std::uint64_t blind = 0;
        for ([[maybe_unused]] auto _ : state) {
            blind += approach.drive();
        }
        if (blind > 0) {
            state.SkipWithError("pairs were not understood: this is not the cost of odometry");
        }
        state.SetItemsProcessed(state.iterations() * kPairs);
    });
}

}  // namespace crspf::cli
