// The whole service on the robot of live_robot.hpp: its lidar on a pseudo terminal, its wheels on a bus, the pose read
// back from another bus.
#pragma once

#include <sys/socket.h>

#include <array>
#include <cerrno>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <system_error>

#include "drivers/can/pose_frames.hpp"
#include "platform/crspfd/service.hpp"
#include "platform/linux/monotonic_clock.hpp"
#include "platform/linux/socketcan.hpp"
#include "tests/support/live_robot.hpp"
#include "tests/support/live_sensors.hpp"

namespace crspf::test {

/// Its real-time threads.
inline constexpr std::array<std::string_view, 6> kServiceThreads{"rx-lidar", "rx-base", "odometry",
                                                                 "filter",   "map",     "output"};

class ServiceBench {
 public:
    /// @param directory for the line, the map and the record
    explicit ServiceBench(const std::filesystem::path& directory) : ServiceBench(directory, config(directory)) {}
    ServiceBench(const std::filesystem::path& directory, const Config& config)
        : urg({.link = directory / "tty", .sensor = urg_04lx(), .scan = revolution}),
          base_(Duration{20'000'000}, wheels) {
        std::array<int, 2> pair{};
        if (::socketpair(AF_UNIX, SOCK_DGRAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0, pair.data()) != 0) {
            throw std::system_error(errno, std::generic_category(), "socket pair");
        }
        controller_ = std::make_unique<SocketCan>(UniqueFd(pair[0]));
        ServiceOptions options;
        options.allow_degraded = true;
        options.open_source = [this](const SourceConfig& source, const LidarParams& lidar) {
            return source.driver == SourceDriver::kCan
                       ? open_live(source, lidar, std::make_unique<SocketCan>(base_.take_bus()))
                       : open_live(source, lidar);
        };
        options.open_bus = [fd = pair[1]](const PoseOutputConfig&) {
            return std::make_unique<SocketCan>(UniqueFd(fd));
        };
        service = std::make_unique<Service>(config, options);
    }

    static Config config(const std::filesystem::path& directory) {
        return robot(directory / "tty", "[pose_output]\ncan = \"can1\"\n[service]\nstate_directory = \"" +
                                            (directory / "state").string() + "\"\nrecord_directory = \"" +
                                            (directory / "runs").string() + "\"\n");
    }

    /// Runs until `done`, or out of patience; true where it was done.
    bool run_until(const std::function<bool()>& done, double patience_s = 20.0) {
        const Stamp end = monotonic_now() + Duration::from_seconds(patience_s);
        while (monotonic_now() < end) {
            CanFrame frame;
            while (controller_->receive(frame, {}).status == IoStatus::kOk) {
                if (const auto pose = decoder.on_frame(frame)) {
                    last_pose = pose;
                    if (on_pose) {
                        on_pose(*pose);
                    }
                }
            }
            for (const ServiceEvent& event : service->tick()) {
                log += event.text + "\n";
            }
            if (done()) {
                return true;
            }
            sleep_until(monotonic_now() + Duration{5'000'000});
        }
        return false;
    }
    bool run_for(double seconds) {
        const Stamp end = monotonic_now() + Duration::from_seconds(seconds);
        return run_until([end] { return monotonic_now() >= end; }, seconds + 1.0);
    }
    /// A scan has been matched well, and the pose of it is on the bus.
    [[nodiscard]] bool pose_known() const { return last_pose && !last_pose->lost && last_pose->result; }

    const Stamp begun = monotonic_now();
    LiveUrg urg;
    std::unique_ptr<Service> service;
    PoseDecoder decoder;
    std::function<void(const PoseReport&)> on_pose;
    std::optional<PoseReport> last_pose;
    std::string log;

 private:
    LiveCanNode base_;
    std::unique_ptr<SocketCan> controller_;
};

}  // namespace crspf::test
