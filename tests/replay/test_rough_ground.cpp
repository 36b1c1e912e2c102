// A vehicle that pitches and rolls over a bumpy field: what its lidar of many rings makes of that.
#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <cstdio>
#include <memory>
#include <string>
#include <vector>

#include "config/config.hpp"
#include "core/base/trig.hpp"
#include "core/odometry/inertial.hpp"
#include "core/slam/obstacle_scan.hpp"
#include "drivers/velodyne/velodyne_assembler.hpp"
#include "platform/files/trajectory.hpp"
#include "tests/unit/platform/scratch.hpp"
#include "tests/unit/sim/command.hpp"
#include "tools/crspf/replay.hpp"
#include "tools/eval/ate.hpp"
#include "tools/sim/capture_writer.hpp"
#include "tools/sim/simulation.hpp"
#include "tools/sim/velodyne_sweep.hpp"
#include "tools/sim/world3d.hpp"

namespace {

using namespace crspf;

constexpr double kBumps_deg = 14.0;
constexpr double kPlace_m = 0.3;   // an obstacle told so near to a true one is that one
constexpr double kReach_m = 19.0;  // nearer than obstacles are told of

/// What was told of the obstacles, against what stands there.
struct Verdict {
    std::size_t told = 0;
    std::size_t told_rightly = 0;
    std::size_t stand = 0;  ///< beams before which a wall, a trunk or a pole stands within reach
    std::size_t found = 0;

    [[nodiscard]] double precision() const { return static_cast<double>(told_rightly) / static_cast<double>(told); }
    [[nodiscard]] double recall() const { return static_cast<double>(found) / static_cast<double>(stand); }
};

/// Listens to the simulated lidar and IMU as the service would.
class Listener final : public sim::LogWriter {
 public:
    explicit Listener(const sim::SimulationParams& params)
        : scanner_(std::make_unique<ObstacleScanner>(
              ObstacleParams{.vehicle_height_m = 1.0, .lidar_height_m = sim::RobotParams{}.lidar_height_m},
              LidarParams{.P_base_lidar = params.P_base_lidar})) {}

    void odometry(const sim::OdometryRecord& record, std::string& /*out*/) override {
        const sim::ImuRecord& imu = record.imu;
        static_cast<void>(filter_->add({.stamp = {record.stamp_us * 1000},
                                        .yaw_rate_radps = imu.rate_radps.z,
                                        .speed_mps = record.speed_mps,
                                        .inertial = Inertial{.roll_rate_radps = imu.rate_radps.x,
                                                             .pitch_rate_radps = imu.rate_radps.y,
                                                             .acceleration_x_mps2 = imu.force_mps2.x,
                                                             .acceleration_y_mps2 = imu.force_mps2.y,
                                                             .acceleration_z_mps2 = imu.force_mps2.z}}));
    }
    void scan(const sim::ScanRecord& /*record*/, std::string& /*out*/) override {}
    void packet(const sim::PacketRecord& record, std::string& /*out*/) override {
        if (record.port == sim::kVelodyneDataPort) {
            assembler_->on_data(record.payload, VelodyneParams{}.source_address, {record.sent_ns},
                                [this](const VelodyneCloud& cloud) {
                                    if (cloud.complete) {
                                        keep(cloud, filter_->attitude(), levelled);
                                        keep(cloud, AttitudeHistory{}, tilted);
                                    }
                                });
        }
    }

    std::vector<std::unique_ptr<Scan>> levelled;  ///< with the IMU
    std::vector<std::unique_ptr<Scan>> tilted;    ///< without

 private:
    void keep(const VelodyneCloud& cloud, const AttitudeHistory& attitude, std::vector<std::unique_ptr<Scan>>& scans) {
        REQUIRE(scanner_->scan(cloud, attitude, *scans.emplace_back(std::make_unique<Scan>())));
    }

    std::unique_ptr<ObstacleScanner> scanner_;
    std::unique_ptr<InertialFilter> filter_ = std::make_unique<InertialFilter>();
    std::unique_ptr<VelodyneAssembler> assembler_ = std::make_unique<VelodyneAssembler>(VelodyneParams{});
};

/// Compares scans with what stands in the world.
class Judge {
 public:
    Judge(const sim::Scene& scene, const sim::SimulationParams& params, std::vector<TimedPose> truth)
        : obstacles_(sim::World3d(scene, sim::Terrain(params.bumps_rad)).obstacles()),
          walls_(scene.world),
          P_base_lidar_(params.P_base_lidar),
          truth_(std::move(truth)) {}

    [[nodiscard]] Verdict judge(const std::vector<std::unique_ptr<Scan>>& scans) const {
        Verdict verdict;
        for (const auto& scan : scans) {
            for (std::uint32_t beam = 0; beam < scan->count; ++beam) {
                judge_beam(*scan, beam, verdict);
            }
        }
        return verdict;
    }

 private:
    void judge_beam(const Scan& scan, std::uint32_t beam, Verdict& verdict) const {
        const double at_s = 1e-9 * static_cast<double>(scan.stamp.ns) + scan.time_per_beam_s * beam;
        const auto later = std::upper_bound(truth_.begin(), truth_.end(), at_s,
                                            [](double s, const TimedPose& pose) { return s < pose.stamp_s; });
        if (later == truth_.begin() || later == truth_.end()) {
            return;
        }
        const TimedPose& before = *std::prev(later);
        const Pose2 P_world_base = interpolate(before.P_map_base, later->P_map_base,
                                               (at_s - before.stamp_s) / (later->stamp_s - before.stamp_s));
        const Pose2 P_world_lidar = P_world_base * P_base_lidar_;
        const SinCos direction =
            sin_cos(P_world_lidar.theta_rad + scan.angle_min_rad + scan.angle_increment_rad * beam);
        const sim::Point lidar{P_world_lidar.x_m, P_world_lidar.y_m};
        const double wall_m = walls_.cast(lidar, direction, 30.0);
        const bool hit = scan.beam[beam] == Beam::kHit;
        const auto range_m = static_cast<double>(scan.range_m[beam]);
        if (hit) {
            const sim::Point told{lidar.x_m + range_m * direction.cos, lidar.y_m + range_m * direction.sin};
            ++verdict.told;
            verdict.told_rightly += obstacles_.clearance(told, 1.0) < kPlace_m ? 1U : 0U;
        }
        if (wall_m < kReach_m) {
            ++verdict.stand;
            // A kerb before it may be told in its stead.
            verdict.found += hit && range_m < wall_m + kPlace_m ? 1U : 0U;
        }
    }

    sim::World obstacles_;
    sim::World walls_;
    Pose2 P_base_lidar_;
    std::vector<TimedPose> truth_;
};

}  // namespace

TEST_CASE("rough ground: what stands is told, what is a bump is not", "[replay]") {
    const sim::Scene scene = sim::make_scene("field");
    sim::SimulationParams params;
    params.lidar = sim::lidar_model("velodyne");
    params.P_base_lidar = {.x_m = 0.1, .y_m = 0.0, .theta_rad = 0.0};
    params.bumps_rad = radians(kBumps_deg);
    params.robot.speed_mps = 1.0;
    params.odometry_rate_hz = 100.0;
    params.duration_s = 10.0;
    params.start_us = sim::kCaptureStart_us;
    Listener listener(params);
    const sim::SimulationResult result = sim::simulate(
        scene, params, listener, [](std::string_view) {}, [](double) {});
    const Judge judge(scene, params, result.truth);
    const Verdict levelled = judge.judge(listener.levelled);
    const Verdict tilted = judge.judge(listener.tilted);
    std::printf("obstacles of a bumpy field: precision %.4f, recall %.4f; without the IMU %.4f, %.4f\n",
                levelled.precision(), levelled.recall(), tilted.precision(), tilted.recall());
    CHECK(levelled.stand > 25000);
    CHECK(levelled.precision() > 0.95);
    CHECK(levelled.recall() > 0.95);
}

TEST_CASE("rough ground: obstacles and an IMU keep the pose where a plain slice loses it", "[replay]") {
    const test::Scratch scratch;
    char bumps[16];
    std::snprintf(bumps, sizeof bumps, "%g", kBumps_deg);
    const std::string capture = (scratch / "run.pcapng").string();
    test::crspf_sim({"--world",     "field",      "--bumps", bumps,         "--lidar",
                     "velodyne",    "--odometer", "imu",     "--odom-rate", "100",
                     "--gyro-bias", "0.5",        "--speed", "1",           "--duration",
                     "25",          "--capture",  capture,   "--out",       (scratch / "sim").string()});
    const std::vector<TimedPose> truth = read_tum(scratch / "sim/truth.tum");
    const auto error_m = [&](PlanarScan planar) {
        ReplayJob job;
        job.logs = {capture};
        job.config = load_config(scratch / "sim/config.toml");
        for (SourceConfig& source : job.config->sources) {
            source.velodyne_planar = planar;
        }
        const auto replay = run_replay(job);
        const auto report = eval::absolute_trajectory_error(replay.trajectory, truth, {});
        REQUIRE(report);
        return report->position_m.rms;
    };
    const double obstacles_m = error_m(PlanarScan::kObstacles);
    const double slice_m = error_m(PlanarScan::kRing);
    std::printf("a bumpy field: %.3f m with obstacles, %.3f m with one ring\n", obstacles_m, slice_m);
    CHECK(obstacles_m < 0.1);
    CHECK(slice_m > 3.0 * obstacles_m);
}
