// The service with another process's odometer: live, blind for a while, started anew, recorded, and played again.
#include <sys/socket.h>

#include <atomic>
#include <catch2/catch.hpp>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <stop_token>
#include <string>
#include <thread>

#include "platform/crspfd/service.hpp"
#include "platform/linux/monotonic_clock.hpp"
#include "platform/service/motion_sender.hpp"
#include "tests/support/live_robot.hpp"
#include "tests/unit/platform/port_peers.hpp"
#include "tests/unit/platform/scratch.hpp"
#include "tools/crspf/replay.hpp"
#include "tools/crspf/top_screen.hpp"
#include "tools/sim/live_sensors.hpp"

using namespace crspf;
using namespace crspf::test;

namespace {

constexpr Duration kPicture{66'000'000};
constexpr Duration kComputation{30'000'000};

/// The odometer's process: pictures of the robot of live_robot.hpp, told some time after they were taken.
class Odometer {
 public:
    explicit Odometer(std::uint16_t port)
        : thread_([this, port](const std::stop_token& stop) {
              const Stamp begin = monotonic_now();
              std::uint32_t session = 1;
              std::optional<MotionSender> sender;
              Pose2 P_before = pose_at(0.0);
              for (Stamp picture = begin; !stop.stop_requested(); picture = picture + kPicture) {
                  sleep_until(picture + kComputation);
                  if (restart_.exchange(false)) {
                      sender.reset();
                  }
                  if (!sender) {
                      sender.emplace(0x7F000001, port, session++);
                  }
                  const Pose2 P_now = pose_at((picture - begin).seconds());
                  sender->send({.stamp = picture,
                                .P_previous_base = inverse(P_before) * P_now,
                                .translation_variance_m2 = blind_ ? 1e-4 : 1e-6,
                                .rotation_variance_rad2 = blind_ ? 1e-4 : 1e-6,
                                .blind = blind_});
                  P_before = P_now;
              }
          }) {}

    void shut_eyes(bool shut) { blind_ = shut; }
    void start_anew() { restart_ = true; }

 private:
    std::atomic<bool> blind_ = false;
    std::atomic<bool> restart_ = false;
    std::jthread thread_;  ///< last: it uses the others
};

Config motion_robot(std::uint16_t port, const std::filesystem::path& directory) {
    return parse_config(
        "[lidar]\nrange_max_m = 5.6\n\n[source.lidar]\ndriver = \"scip\"\nport = \"" + (directory / "tty").string() +
            "\"\n\n[source.stereo]\ndriver = \"motion\"\nport = \"udp://127.0.0.1:" + std::to_string(port) +
            "\"\n\n[service]\nstate_directory = \"" + (directory / "state").string() + "\"\nrecord_directory = \"" +
            (directory / "runs").string() + "\"\n",
        "robot");
}

}  // namespace

TEST_CASE("service: another process's odometer, live, blind, started anew, and played again to the live poses",
          "[real-kernel]") {
    const Scratch scratch;
    const std::uint16_t port = free_port(SOCK_DGRAM);
    ServiceOptions options;
    options.allow_degraded = true;
    Service service(motion_robot(port, scratch.directory()), options);
    service.start();
    const sim::LiveUrg urg({.link = scratch / "tty", .sensor = urg_04lx(), .scan = revolution});
    Odometer odometer(port);

    nlohmann::ordered_json status;
    std::string log;
    const auto run_until = [&](const std::function<bool()>& done) {
        const Stamp end = monotonic_now() + Duration{30'000'000'000};
        while (monotonic_now() < end) {
            sleep_until(monotonic_now() + Duration{20'000'000});
            for (const ServiceEvent& event : service.tick()) {
                log += event.text + "\n";
            }
            status = service.status();
            if (done()) {
                return true;
            }
        }
        return false;
    };
    const auto way_m = [&] {
        return std::hypot(status["pose"]["x_m"].get<double>(), status["pose"]["y_m"].get<double>());
    };
    const auto stereo = [&]() -> const nlohmann::ordered_json& { return status["sources"][1]; };

    REQUIRE(run_until([&] { return way_m() > 0.3; }));
    INFO(status.dump(1));
    CHECK(stereo()["state"] == "ok");
    CHECK(stereo()["says"] == "streaming");
    CHECK(status["odometry"]["blind_s"] == 0.0);
    CHECK(status["pose"]["speed_mps"].get<double>() == Approx(kSpeed_mps).margin(0.05));
    CHECK_FALSE(status["pose"]["lost"].get<bool>());

    // Blind, with a lidar that sees: it goes on, and says so.
    odometer.shut_eyes(true);
    REQUIRE(
        run_until([&] { return stereo()["state"] == "blind" && status["odometry"]["blind_s"].get<double>() > 1.2; }));
    CHECK(stereo()["says"].get<std::string>().starts_with("blind for "));
    CHECK_FALSE(status["pose"]["lost"].get<bool>());
    CHECK(log.find("source stereo: blind: blind for ") != std::string::npos);
    std::string screen;
    for (const std::string& line : cli::top_screen(status, nullptr, 120)) {
        screen += line + "\n";
    }
    CHECK(screen.find("blind for ") != std::string::npos);
    odometer.shut_eyes(false);
    REQUIRE(run_until([&] { return stereo()["state"] == "ok"; }));

    // Another process takes its place, whose frame begins elsewhere.
    odometer.start_anew();
    REQUIRE(run_until([&] { return stereo()["counts"]["restarts"] == 1; }));
    const auto scans = status["filter"]["scans"].get<int>();
    REQUIRE(run_until([&] { return status["filter"]["scans"].get<int>() > scans + 10; }));
    INFO(status.dump(1));
    CHECK_FALSE(status["pose"]["lost"].get<bool>());
    CHECK(status["output"]["jumps"] == 0);
    CHECK(stereo()["counts"]["lost"] == 0);
    CHECK(stereo()["counts"]["ran_back"] == 0);
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
