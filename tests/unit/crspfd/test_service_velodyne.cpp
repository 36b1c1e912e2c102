// The service with a lidar of many lasers: its revolutions are levelled and matched live, recorded, and played again.
#include <sys/socket.h>

#include <catch2/catch.hpp>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>

#include "platform/crspfd/service.hpp"
#include "platform/linux/monotonic_clock.hpp"
#include "platform/linux/socketcan.hpp"
#include "tests/support/live_robot.hpp"
#include "tests/unit/drivers/velodyne_stream.hpp"
#include "tests/unit/platform/port_peers.hpp"
#include "tests/unit/platform/scratch.hpp"
#include "tools/crspf/replay.hpp"
#include "tools/sim/live_sensors.hpp"

using namespace crspf;
using namespace crspf::test;

namespace {

constexpr double kLidarHeight_m = 0.6;
constexpr double kPacket_s = 1.327e-3;

/// The room of live_robot.hpp, with a floor.
std::uint16_t distance_seen(double seconds, double azimuth_rad, std::uint32_t laser) {
    const double up_rad = radians(laser % 2 == 0 ? laser - 15.0 : laser);  // as a VLP-16's lasers are numbered
    const double wall_m = range_m(pose_at(seconds), -azimuth_rad) / std::cos(up_rad);
    const double floor_m = up_rad < 0.0 ? kLidarHeight_m / -std::sin(up_rad) : 100.0;
    return static_cast<std::uint16_t>(std::lround(std::min(wall_m, floor_m) / 0.002));
}

Config velodyne_robot(std::uint16_t port, const std::filesystem::path& directory) {
    std::string toml = live_robot_toml("nowhere", "can0");
    const std::string scip = "driver = \"scip\"\nport = \"nowhere\"\n";
    toml.replace(toml.find(scip), scip.size(),
                 "driver = \"velodyne\"\nmodel = \"VLP-16\"\nplanar = \"obstacles\"\naddress = \"127.0.0.1\"\n"
                 "port = \"udp://127.0.0.1:" +
                     std::to_string(port) + "\"\n");
    toml += "\n[obstacles]\nlidar_height_m = 0.6\nvehicle_height_m = 0.8\n\n[service]\nstate_directory = \"" +
            (directory / "state").string() + "\"\nrecord_directory = \"" + (directory / "runs").string() + "\"\n";
    return parse_config(toml, "robot");
}

}  // namespace

TEST_CASE("service: a Velodyne's revolutions, live, recorded, and played again to the live poses", "[real-kernel]") {
    const Scratch scratch;
    const std::uint16_t port = free_port(SOCK_DGRAM);
    sim::LiveCanNode base(Duration{20'000'000}, wheels);
    ServiceOptions options;
    options.allow_degraded = true;
    options.open_source = [&base](const SourceConfig& source, const LidarParams& lidar) {
        return source.driver == SourceDriver::kCan
                   ? open_live(source, lidar, std::make_unique<SocketCan>(base.take_bus()))
                   : open_live(source, lidar);
    };
    Service service(velodyne_robot(port, scratch.directory()), options);
    service.start();
    VelodyneStream stream(VelodyneModel::kVlp16);
    const sim::LiveVelodyne lidar(port, Duration::from_seconds(kPacket_s), [&stream](std::uint64_t index) {
        const double seconds = kPacket_s * static_cast<double>(index);
        return stream.next_bytes([seconds](double azimuth_rad, std::uint32_t laser, std::uint32_t) {
            return distance_seen(seconds, azimuth_rad, laser);
        });
    });
    const Stamp end = monotonic_now() + Duration{20'000'000'000};
    nlohmann::ordered_json status;
    bool away = false;
    do {
        sleep_until(monotonic_now() + Duration{50'000'000});
        static_cast<void>(service.tick());
        status = service.status();
        const auto P = service.pose();
        away = away || std::hypot(P["x_m"].get<double>(), P["y_m"].get<double>()) >= 0.4;
    } while ((!away || status["filter"]["scans"].get<int>() < 30) && monotonic_now() < end);
    INFO(status.dump(1));
    CHECK(away);
    CHECK(status["filter"]["key_frames"].get<int>() > 10);
    CHECK(status["filter"]["rays"].get<int>() > 500);
    service.stop();

    ReplayJob job;
    for (const auto& entry : std::filesystem::directory_iterator(scratch / "runs")) {
        job.logs.push_back(entry.path());
    }
    const ReplayOutcome replay = run_replay(job);
    CHECK(replay.live_same > 15);
    CHECK(replay.live_other == 0);
    CHECK(replay.live_same == replay.trajectory.size());
}
