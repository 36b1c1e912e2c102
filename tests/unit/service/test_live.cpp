// A robot in real time: its lidar on a serial line, its wheels on a bus, heard by live sources, recorded and mapped at
// once; then the recording alone.
#include <algorithm>
#include <array>
#include <catch2/catch.hpp>
#include <cmath>
#include <cstring>
#include <ctime>
#include <filesystem>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "config/config.hpp"
#include "core/base/trig.hpp"
#include "core/slam/pipeline.hpp"
#include "platform/capture/recorder.hpp"
#include "platform/linux/monotonic_clock.hpp"
#include "platform/linux/serial_port.hpp"
#include "platform/linux/socketcan.hpp"
#include "platform/service/live_source.hpp"
#include "tests/support/live_sensors.hpp"
#include "tests/unit/drivers/scip_bench.hpp"
#include "tests/unit/platform/scratch.hpp"
#include "tools/crspf/replay.hpp"

using namespace crspf;
using crspf::test::LiveCanNode;
using crspf::test::LiveUrg;
using crspf::test::Scratch;

namespace {

constexpr double kStill_s = 1.5;
constexpr double kSpeed_mps = 0.25;
constexpr double kTurn_radps = 0.4;
constexpr double kSpan_m = 0.3;
constexpr double kCount_m = 1e-4;

/// Stands, then drives in a circle.
Pose2 pose_at(double seconds) {
    const double t = std::max(seconds - kStill_s, 0.0);
    const double radius_m = kSpeed_mps / kTurn_radps;
    const double heading_rad = kTurn_radps * t;
    return {.x_m = radius_m * std::sin(heading_rad),
            .y_m = radius_m * (1.0 - std::cos(heading_rad)),
            .theta_rad = wrap_angle(heading_rad)};
}

/// To the walls of a room of 5 m x 4 m with a pillar.
double range_m(const Pose2& P, double angle_rad) {
    const double dx = std::cos(P.theta_rad + angle_rad);
    const double dy = std::sin(P.theta_rad + angle_rad);
    double nearest_m = std::min(((dx > 0.0 ? 3.0 : -2.0) - P.x_m) / dx, ((dy > 0.0 ? 2.5 : -1.5) - P.y_m) / dy);
    const double px = 2.0 - P.x_m;
    const double py = -0.5 - P.y_m;
    const double along = px * dx + py * dy;
    const double aside = px * dy - py * dx;
    if (along > 0.0 && std::abs(aside) < 0.2) {
        nearest_m = std::min(nearest_m, along - std::sqrt(0.04 - aside * aside));
    }
    return nearest_m;
}

void revolution(std::uint64_t number, std::span<std::uint32_t> step_mm) {
    const ScipSensor sensor = crspf::test::urg_04lx();
    for (std::size_t i = 0; i < step_mm.size(); ++i) {
        const double turn = static_cast<double>(i) / sensor.ares;
        const double angle_rad = 2.0 * kPi * (turn - static_cast<double>(sensor.afrt) / sensor.ares);
        const Pose2 P = pose_at((static_cast<double>(number) + turn) * sensor.period_s());
        step_mm[i] = static_cast<std::uint32_t>(1000.0 * range_m(P, angle_rad) + 0.5);
    }
}

std::vector<CanFrame> wheels(std::uint64_t tick) {
    const double t = std::max(0.02 * static_cast<double>(tick) - kStill_s, 0.0);
    std::vector<CanFrame> frames(2);
    for (std::size_t side = 0; side < 2; ++side) {
        const double speed_mps = kSpeed_mps + (side == 0 ? -0.5 : 0.5) * kTurn_radps * kSpan_m;
        const auto counts = static_cast<std::int32_t>(speed_mps * t / kCount_m);
        frames[side].id = static_cast<std::uint32_t>(side + 1);
        frames[side].length = 4;
        std::memcpy(frames[side].data.data(), &counts, sizeof counts);
    }
    return frames;
}

Config robot(const std::filesystem::path& line) {
    return parse_config(
        "[lidar]\nrange_max_m = 5.6\n[odometry]\nwheel_span_m = 0.3\n[source.lidar]\ndriver = \"scip\"\n"
        "port = \"" +
            line.string() +
            "\"\n[source.base]\ndriver = \"can\"\nport = \"can0\"\n"
            "dbc_text = \"\"\"\nBO_ 1 L: 4 X\n SG_ C : 0|32@1- (1,0) [0|0] \\\"\\\" X\n"
            "BO_ 2 R: 4 X\n SG_ C : 0|32@1- (1,0) [0|0] \\\"\\\" X\n\"\"\"\n"
            "[source.base.left]\nsignal = \"L.C\"\nscale = 1e-4\n"
            "[source.base.right]\nsignal = \"R.C\"\nscale = 1e-4\n",
        "robot.toml");
}

/// Maps what comes.
class Mapper final : public SampleSink {
 public:
    explicit Mapper(const Config& config) : pipeline(std::make_unique<Pipeline>(config.slam)) {}
    void on_scan(const Scan& scan) override { poses.push_back(pipeline->on_scan(scan).P_map_base); }
    void on_wheel(const DifferentialSample& sample) override { pipeline->on_wheel(sample); }
    void on_wheel(const AckermannSample& sample) override { pipeline->on_wheel(sample); }
    void on_imu(const ImuSample& sample) override { pipeline->on_imu(sample); }

    std::unique_ptr<Pipeline> pipeline;
    std::vector<Pose2> poses;
};

/// Records one source of the recorder's.
class Recording final : public TrafficSink {
 public:
    Recording(Recorder& recorder, std::uint32_t source) : recorder_(recorder), source_(source) {}
    void on_traffic(Direction direction, Stamp stamp, std::span<const std::uint8_t> bytes) override {
        lost += recorder_.append(source_, direction, stamp, bytes) ? 0 : 1;
    }
    int lost = 0;

 private:
    Recorder& recorder_;
    std::uint32_t source_;
};

}  // namespace

TEST_CASE("live: a run that was recorded gives the same poses when it is played again") {
    const Scratch scratch;
    const Config config = robot(scratch / "tty");
    LiveUrg urg({.link = scratch / "tty", .sensor = crspf::test::urg_04lx(), .scan = revolution});
    LiveCanNode base(Duration{20'000'000}, wheels);
    const SourceConfig& base_config = config.sources[0];
    const SourceConfig& lidar_config = config.sources[1];
    REQUIRE(lidar_config.driver == SourceDriver::kScip);

    RecorderParams params;
    params.directory = scratch.directory();
    params.free_bytes_min = 1;
    params.utc_minus_stamp = clock_now(CLOCK_REALTIME) - monotonic_now();
    Recorder recorder(params,
                      {{.name = "base", .description = {}, .link = link_of(base_config.driver)},
                       {.name = "lidar", .description = {}, .link = link_of(lidar_config.driver)}},
                      print_config(config));
    Mapper mapper(config);
    {
        Recording base_traffic(recorder, 0);
        Recording lidar_traffic(recorder, 1);
        const auto lidar = open_live(lidar_config, config.slam.lidar);
        const auto bus = open_live(base_config, config.slam.lidar, std::make_unique<SocketCan>(base.take_bus()));
        const Stamp end = monotonic_now() + Duration{8'000'000'000};
        bool unplugged = false;
        while (monotonic_now() < end) {
            lidar->step(Duration{1'000'000}, mapper, lidar_traffic);
            bus->step(Duration{1'000'000}, mapper, base_traffic);
            if (!unplugged && mapper.poses.size() >= 20) {  // a run has its accidents
                unplugged = true;
                urg.unplug();
                urg.garble(100);
                urg.plug_in();
            }
        }
        CHECK(unplugged);
        CHECK(base_traffic.lost + lidar_traffic.lost == 0);
        INFO(lidar->report().state.view() << "; " << bus->report().state.view());
        REQUIRE(mapper.poses.size() > 25);
    }
    REQUIRE(recorder.flush());

    ReplayJob job;
    job.logs = {recorder.file()};
    const ReplayOutcome replay = run_replay(job);
    REQUIRE(replay.trajectory.size() == mapper.poses.size());
    for (std::size_t i = 0; i < mapper.poses.size(); ++i) {
        REQUIRE(replay.trajectory[i].P_map_base == mapper.poses[i]);
    }
    // And they are poses of that robot: the way it has gone, not a standstill.
    const Pose2& last = mapper.poses.back();
    CHECK(std::hypot(last.x_m, last.y_m) > 0.2);
}
