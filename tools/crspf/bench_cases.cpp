#include "tools/crspf/bench_cases.hpp"

#include <benchmark/benchmark.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "core/base/rng.hpp"
#include "core/slam/critical_rays.hpp"
#include "core/slam/direct_match.hpp"
#include "core/slam/map_update.hpp"
#include "core/slam/match_field.hpp"
#include "core/slam/match_objective.hpp"
#include "core/slam/scan_points.hpp"
#include "core/slam/slam_params.hpp"
#include "tools/crspf/bench_drive.hpp"
#include "tools/crspf/bench_obstacles.hpp"
#include "tools/crspf/bench_stereo.hpp"
#include "tools/crspf/bench_streams.hpp"
#include "tools/crspf/bench_velodyne.hpp"
#include "tools/crspf/map_copies.hpp"

namespace crspf::cli {
namespace {

// The names of the cases.
constexpr const char* kFormula = "evaluation/formula_10";
constexpr const char* kPortable = "evaluation/field_portable";
constexpr const char* kVector = "evaluation/field_vector";
constexpr const char* kMap1 = "on_scan/map_x1";
constexpr const char* kMap16 = "on_scan/map_x16";
constexpr const char* kCritical180 = "critical_rays/180_beams";
constexpr const char* kCritical720 = "critical_rays/720_beams";
constexpr const char* kCritical2000 = "critical_rays/2000_beams";
constexpr const char* kUpdateKnown = "map_update/known_area";
constexpr const char* kUpdateNew = "map_update/new_area";
constexpr const char* kScan181 = "on_scan/181_beams";
constexpr const char* kScan682 = "on_scan/682_beams";
constexpr const char* kScan1081 = "on_scan/1081_beams";

constexpr BenchRatio kRatios[] = {
    {kVector, kFormula, BenchRatio::Of::kRate, "match field (vector) / formula (10) directly",
     "evaluations per second"},
    {kPortable, kFormula, BenchRatio::Of::kRate, "match field (portable) / formula (10) directly",
     "evaluations per second"},
    {kVector, kPortable, BenchRatio::Of::kRate, "match field (vector) / match field (portable)",
     "evaluations per second"},
    {kMap16, kMap1, BenchRatio::Of::kTime, "map 16 times as large / map", "time per scan"},
    {kCritical720, kCritical180, BenchRatio::Of::kTime, "critical rays of 720 beams / of 180 (4.0 x beams)", "time"},
    {kCritical2000, kCritical180, BenchRatio::Of::kTime, "critical rays of 2000 beams / of 180 (11.1 x beams)", "time"},
    {kUpdateNew, kUpdateKnown, BenchRatio::Of::kTime, "map update in a new area / in a known one", "time per scan"},
    {kScan682, kScan181, BenchRatio::Of::kTime, "on_scan of 682 beams / of 181 (3.8 x beams)", "time per scan"},
    {kScan1081, kScan181, BenchRatio::Of::kTime, "on_scan of 1081 beams / of 181 (6.0 x beams)", "time per scan"},
};

// One return of each laser. Sources: drivers/velodyne/velodyne_models.hpp.
constexpr BenchRealTime kRealTimes[] = {
    {kVelodyneVlp16, 754.0, "VLP-16"},
    {kVelodyneVlp32c, 1507.0, "VLP-32C"},
    {kVelodyneHdl32e, 1808.0, "HDL-32E"},
    {kVelodyneHdl64e, 3472.0, "HDL-64E S2"},
    {kObstaclesVlp16, 10.0, "VLP-16, in revolutions"},
    {kObstaclesHdl64e, 10.0, "HDL-64E S2, in revolutions"},
    {kScipUtm30lx, 40.0, "UTM-30LX"},
    {kStereoPair, 10.0, "stereo camera as KITTI's, in pairs"},
    {kCanWheels, 8771.0, "CAN bus at 1 Mbit/s that is full"},  // of frames of 8 bytes, 114 bits without stuffing
};

constexpr double kShortDrive_s = 10.0;
constexpr double kDrive_s = 20.0;
/// The scan as seen from a robot that stands still.
void place(const Scan& scan, const LidarParams& lidar, ScanPoints& points) {
    const auto projector = std::make_unique<ScanProjector>(lidar, false);
    const auto standing = std::make_unique<Odometry>(OdometryParams{});
    projector->project(scan, *standing, points);
}

// ---- One particle's evaluation: m of (10) for 720 rays at the end of a drive, in the map drawn on the way.

class EvaluationBench {
 public:
    EvaluationBench()
        : portable_(params_, Kernel::kPortable),
          fastest_(params_, Kernel::kFastest),
          map_(params_.map, params_.lidar.range_noise_m) {
        const sim::SampleDrive drive = drive_through_office(sim::all_round_lidar(kBeams), kShortDrive_s);
        for (std::size_t i = 0; i < drive.steps.size(); ++i) {
            place(drive.steps[i].scan, drive.lidar, points_);
            changes_.clear();
            map_.draw(points_, drive.truth[i], true, changes_);
            field_.follow(changes_.view());
        }
        std::make_unique<CriticalRays>(params_.critical_rays, params_.lidar.range_noise_m)->select(points_, critical_);
        take_points();
        const Pose2 truth = drive.truth.back();
        usable_ = aim(portable_, truth) && aim(fastest_, truth);
        Rng rng(1);
        for (Pose2& pose : poses_) {
            pose = {.x_m = truth.x_m + kSearch_m * rng.symmetric(),
                    .y_m = truth.y_m + kSearch_m * rng.symmetric(),
                    .theta_rad = truth.theta_rad + kSearch_rad * rng.symmetric()};
            usable_ = usable_ && agree(pose);
        }
    }

    [[nodiscard]] double formula(const Pose2& pose) const {
        return direct_match(map_.map(), critical_points_, ordinary_points_, params_.critical_rays.weight, pose,
                            cells_per_metre());
    }
    [[nodiscard]] double portable(const Pose2& pose) const { return portable_.match(pose); }
    [[nodiscard]] double fastest(const Pose2& pose) const { return fastest_.match(pose); }

    /// Calls one of the three for each pose in turn.
    void measure(benchmark::State& state, double (EvaluationBench::*match)(const Pose2&) const) const {
        if (!usable_) {
            state.SkipWithError("formula (10) and the match field differ: nothing to compare");
            return;
        }
        std::size_t i = 0;
        for ([[maybe_unused]] auto _ : state) {
            benchmark::DoNotOptimize((this->*match)(poses_[i]));
            i = (i + 1) % poses_.size();
        }
        state.SetItemsProcessed(state.iterations());
    }

 private:
    static constexpr std::uint32_t kBeams = 720;
    static constexpr double kSearch_m = 0.1;
    static constexpr double kSearch_rad = 0.05;

    [[nodiscard]] double cells_per_metre() const { return 1.0 / params_.map.resolution_m; }

    void take_points() {
        const auto scale = static_cast<float>(cells_per_metre());
        std::uint32_t used = 0;
        const auto take = [&](bool kind) {
            const std::uint32_t begin = used;
            for (std::uint32_t i = 0; i < points_.count; ++i) {
                if (critical_[i] == kind) {
                    x_[used] = points_.x_m[i] * scale;
                    y_[used] = points_.y_m[i] * scale;
                    ++used;
                }
            }
            return FieldPoints{.x = x_.data() + begin, .y = y_.data() + begin, .count = used - begin};
        };
        critical_points_ = take(true);
        ordinary_points_ = take(false);
    }

    [[nodiscard]] bool aim(MatchObjective& objective, const Pose2& P_map_base) {
        objective.load(points_, critical_, normals_);
        return objective.aim(field_, P_map_base,
                             {.P_from_to = {}, .translation_stddev_m = 1.0, .rotation_stddev_rad = 1.0});
    }

    /// The three compute the same. A point may fall on a cell's edge and be rounded to either side: one ray's worth.
    [[nodiscard]] bool agree(const Pose2& pose) const {
        const double tolerance = kMatchMax * params_.critical_rays.weight / kBeams;
        return portable(pose) == fastest(pose) && std::abs(portable(pose) - formula(pose)) <= tolerance;
    }

    SlamParams params_;
    MatchObjective portable_;
    MatchObjective fastest_;
    MapUpdate map_;
    MatchField field_;
    ChangeList changes_;
    ScanPoints points_;
    std::array<bool, capacity::kBeams> critical_{};
    SurfaceNormals normals_{0.01};  // not measured: evaluations do not ask
    std::array<float, capacity::kBeams + kPointLanes> x_{};
    std::array<float, capacity::kBeams + kPointLanes> y_{};
    FieldPoints critical_points_;
    FieldPoints ordinary_points_;
    std::array<Pose2, 1024> poses_;
    bool usable_ = false;
};

void register_evaluation(const char* name, double (EvaluationBench::*match)(const Pose2&) const) {
    benchmark::RegisterBenchmark(name, [match](benchmark::State& state) {
        static const auto bench = std::make_unique<EvaluationBench>();
        bench->measure(state, match);
    });
}

// ---- Whole scans with their odometry, in an area that is mapped already. An iteration is a lap, so that all cases of
// a lidar play the same scans.

std::unique_ptr<Laps> mapped_office(const char* lidar) {
    auto laps = std::make_unique<Laps>(drive_through_office(sim::lidar_model(lidar), kDrive_s));
    laps->play();
    return laps;
}

/// The same in a map of 16 times as many tiles: the office and 15 copies of it.
std::unique_ptr<Laps> mapped_offices(const char* lidar) {
    auto laps = mapped_office(lidar);
    load_copies(laps->pipeline().map(), 15, laps->pipeline());
    return laps;
}

void register_laps(const char* name, std::unique_ptr<Laps> (*make)(const char*), const char* lidar) {
    const auto laps = std::make_shared<std::unique_ptr<Laps>>();
    benchmark::RegisterBenchmark(name, [make, lidar, laps](benchmark::State& state) {
        if (*laps == nullptr) {
            *laps = make(lidar);
        }
        std::uint64_t scans = 0;
        std::uint64_t matched = 0;
        for ([[maybe_unused]] auto _ : state) {
            matched += (*laps)->play();
            scans += (*laps)->scans();
        }
        if (matched < scans) {
            state.SkipWithError("scans were not matched: this is not the cost of matching");
        }
        state.SetItemsProcessed(static_cast<std::int64_t>(scans));
    });
}

// ---- Critical rays, of one scan in the office.

void register_critical_rays(const char* name, std::uint32_t beams) {
    benchmark::RegisterBenchmark(name, [beams](benchmark::State& state) {
        const SlamParams params;
        const sim::SampleDrive drive = drive_through_office(sim::all_round_lidar(beams), 0.2);
        const auto points = std::make_unique<ScanPoints>();
        place(drive.steps.front().scan, drive.lidar, *points);
        const auto finder = std::make_unique<CriticalRays>(params.critical_rays, params.lidar.range_noise_m);
        const auto critical = std::make_unique<std::array<bool, capacity::kBeams>>();
        for ([[maybe_unused]] auto _ : state) {
            benchmark::DoNotOptimize(finder->select(*points, *critical));
        }
        state.SetItemsProcessed(state.iterations());
    });
}

// ---- Map update: the scans of a drive drawn at their true poses.

class MapUpdateBench {
 public:
    MapUpdateBench() {
        const sim::SampleDrive drive = drive_through_office(sim::lidar_model("urg"), kShortDrive_s);
        for (std::size_t i = 0; i < drive.steps.size(); ++i) {
            auto& placed = placed_.emplace_back();
            placed.P_map_base = drive.truth[i];
            place(drive.steps[i].scan, drive.lidar, placed.points);
        }
        clear_map();
    }

    /// Forgets everything. Costs the tiles' directory, so not to be timed.
    void clear_map() { map_.emplace(params_.map, params_.lidar.range_noise_m); }

    void draw_next() {
        changes_.clear();
        map_->draw(placed_[at_].points, placed_[at_].P_map_base, true, changes_);
        at_ = (at_ + 1) % placed_.size();
    }

    [[nodiscard]] std::size_t scans() const { return placed_.size(); }

 private:
    struct Placed {
        Pose2 P_map_base;
        ScanPoints points;
    };
    SlamParams params_;
    std::vector<Placed> placed_;
    std::size_t at_ = 0;
    std::optional<MapUpdate> map_;
    ChangeList changes_;
};

void update_known_area(benchmark::State& state) {
    static const auto bench = [] {
        auto made = std::make_unique<MapUpdateBench>();
        for (std::size_t i = 0; i < made->scans(); ++i) {
            made->draw_next();
        }
        return made;
    }();
    for ([[maybe_unused]] auto _ : state) {
        bench->draw_next();
    }
    state.SetItemsProcessed(state.iterations());
}

void update_new_area(benchmark::State& state) {
    static const auto bench = std::make_unique<MapUpdateBench>();
    for ([[maybe_unused]] auto _ : state) {
        state.PauseTiming();
        bench->clear_map();
        state.ResumeTiming();
        bench->draw_next();
    }
    state.SetItemsProcessed(state.iterations());
}

}  // namespace

void register_bench_cases() {
    // NOLINTBEGIN(clang-analyzer-cplusplus.NewDeleteLeaks): the library keeps and frees what is registered
    register_evaluation(kFormula, &EvaluationBench::formula);
    register_evaluation(kPortable, &EvaluationBench::portable);
    if (field_sum_kernel(Kernel::kFastest) != field_sum_portable) {
        register_evaluation(kVector, &EvaluationBench::fastest);
    }
    register_laps(kMap1, mapped_office, "urg");
    register_laps(kMap16, mapped_offices, "urg");
    register_critical_rays(kCritical180, 180);
    register_critical_rays(kCritical720, 720);
    register_critical_rays(kCritical2000, 2000);
    benchmark::RegisterBenchmark(kUpdateKnown, update_known_area);
    benchmark::RegisterBenchmark(kUpdateNew, update_new_area);
    register_laps(kScan181, mapped_office, "lms");
    register_laps(kScan682, mapped_office, "urg");
    register_laps(kScan1081, mapped_office, "scan270");
    register_velodyne_cases();
    register_obstacle_cases();
    register_stream_cases();
    register_stereo_cases();
    // NOLINTEND(clang-analyzer-cplusplus.NewDeleteLeaks)
}

std::span<const BenchRatio> bench_ratios() {
    return kRatios;
}

std::span<const BenchRealTime> bench_real_times() {
    return kRealTimes;
}

}  // namespace crspf::cli
