// A robot in real time: its lidar on a serial line, its wheels on a bus, heard by live sources, recorded and mapped at
// once; then the recording alone.
#include <algorithm>
#include <array>
#include <catch2/catch.hpp>
#include <cmath>
#include <ctime>
#include <filesystem>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "config/config.hpp"
#include "core/slam/pipeline.hpp"
#include "platform/capture/recorder.hpp"
#include "platform/linux/monotonic_clock.hpp"
#include "platform/linux/serial_port.hpp"
#include "platform/linux/socketcan.hpp"
#include "platform/service/live_source.hpp"
#include "tests/support/live_robot.hpp"
#include "tests/unit/drivers/scip_bench.hpp"
#include "tests/unit/platform/scratch.hpp"
#include "tools/crspf/replay.hpp"
#include "tools/sim/live_sensors.hpp"

using namespace crspf;
using crspf::sim::LiveCanNode;
using crspf::sim::LiveUrg;
using crspf::test::revolution;
using crspf::test::robot;
using crspf::test::Scratch;
using crspf::test::wheels;

namespace {

/// Maps what comes.
class Mapper final : public SampleSink {
 public:
    explicit Mapper(const Config& config) : pipeline(std::make_unique<Pipeline>(config.slam)) {}
    void on_scan(const Scan& scan) override { poses.push_back(pipeline->on_scan(scan).P_map_base); }
    void on_cloud(const Cloud& /*cloud*/) override {}
    void on_wheel(const DifferentialSample& sample) override { pipeline->on_wheel(sample); }
    void on_wheel(const AckermannSample& sample) override { pipeline->on_wheel(sample); }
    void on_imu(const ImuSample& sample) override { pipeline->on_imu(sample); }
    void on_motion(const MotionSample& sample) override { pipeline->on_motion(sample); }

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

TEST_CASE("live: a run that was recorded gives the same poses when it is played again", "[real-kernel]") {
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
